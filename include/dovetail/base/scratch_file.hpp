/// Room on disk for what does not fit into memory.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

namespace dovetail {

/// A file without a name: however the process ends, killed or crashed with the machine, the system takes it
/// back, and there is nothing to be found, locked or cleaned at the next start. Filled from front to back,
/// read anywhere. Local. Errors (output): a folder that is missing or cannot be written, a full disk, a limit
/// of file sizes, a failing disk; all name the folder.
class ScratchFile {
public:
  explicit ScratchFile(std::string folder);
  ScratchFile(ScratchFile &&other) noexcept;
  ScratchFile(const ScratchFile &) = delete;
  ScratchFile &operator=(const ScratchFile &) = delete;
  ScratchFile &operator=(ScratchFile &&) = delete;
  ~ScratchFile();

  std::int64_t bytes() const { return bytes_; }
  /// Writes behind what is there and returns where.
  std::int64_t append(std::span<const std::byte> data);
  void read_at(std::int64_t offset, std::span<std::byte> into) const;
  /// Gives disk space back, where the file system can do that; what is there must not be read any more.
  void forget(std::int64_t offset, std::int64_t bytes) const;

private:
  [[noreturn]] void fail(const char *what, int error_number, const char *remedy) const;

  std::string folder_;
  int descriptor_ = -1;
  std::int64_t bytes_ = 0;
};

/// Local. Bytes that are free in the file system of this folder; -1 where it does not tell.
std::int64_t free_bytes_in(const std::string &folder);

} // namespace dovetail
