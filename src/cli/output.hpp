/// What can be known about an output before any work is done for it, and small files written whole or not at
/// all.
#pragma once

#include "dovetail/comm/communicator.hpp"

#include <span>
#include <string>
#include <string_view>

namespace dovetail::cli {

/// Collective. Nobody shall wait an hour for a typing error: throws an Error of kind output (usage for the
/// extension) unless `path` can be made now, that is, its folder exists and may be written to, it is no
/// folder itself, and it is none of `inputs`. `extensions`, if not empty, are those allowed, such as ".npy".
/// Looks from the root alone.
void check_output(const Communicator &comm, const std::string &path, std::span<const std::string> inputs,
                  std::span<const std::string_view> extensions);

/// Collective. The same for the file of --report, which is not to be `output` either; an empty name is none
/// and is always right.
void check_report(const Communicator &comm, const std::string &report, std::span<const std::string> inputs,
                  const std::string &output);

/// Collective; only the root's text counts. `path` becomes the whole text or stays what it was. Throws an
/// Error of kind output.
void write_text_file(const Communicator &comm, const std::string &path, const std::string &text);

} // namespace dovetail::cli
