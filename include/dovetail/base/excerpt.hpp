/// Words out of files, as they can be quoted to people. Local.
#pragma once

#include <string>
#include <string_view>

namespace dovetail {

/// The beginning of a text, with '?' for control characters and for bytes beyond ASCII that are not UTF-8. An
/// Error's what() has no control characters either.
std::string excerpt(std::string_view text);

/// Whether a text can be a name in every format of files and in messages: UTF-8 without control characters.
bool is_printable(std::string_view text);

} // namespace dovetail
