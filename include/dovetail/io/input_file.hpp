/// A file that is read by byte ranges, and what the system says of files in words for people.
#pragma once

#include "dovetail/base/error.hpp"

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

namespace dovetail {

/// The problem behind an errno: `what` ("cannot be opened"), the system's reason, and a remedy that fits both
/// the reason and the kind (input or output).
Problem file_problem(ErrorKind kind, const std::string &path, const std::string &what, int error_number);

/// An open regular file, or one in memory. Local; every failure is an Error of kind input that names the
/// file.
class InputFile {
public:
  explicit InputFile(std::string path);
  /// Bytes that outlive it, as if they were a file of this name.
  InputFile(std::string name, std::span<const std::byte> contents);
  InputFile(InputFile &&other) noexcept;
  InputFile(const InputFile &) = delete;
  InputFile &operator=(InputFile &&) = delete;
  InputFile &operator=(const InputFile &) = delete;
  ~InputFile();

  const std::string &path() const { return path_; }
  /// Length when it was opened.
  std::int64_t bytes() const { return bytes_; }
  /// Fills `into` from `offset` on. A file that ends before that is an Error.
  void read_at(std::int64_t offset, std::span<std::byte> into) const;

  /// An Error about this file, at this byte.
  [[noreturn]] void refuse(std::int64_t byte, const std::string &what, const std::string &remedy) const;

private:
  std::string path_;
  std::int64_t bytes_ = 0;
  int descriptor_ = -1; ///< none for contents in memory
  std::span<const std::byte> contents_;
};

} // namespace dovetail
