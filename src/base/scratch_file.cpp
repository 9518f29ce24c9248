#include "dovetail/base/scratch_file.hpp"

#include "dovetail/base/error.hpp"

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <utility>

#include <fcntl.h>
#include <sys/statvfs.h>
#include <unistd.h>

namespace dovetail {
namespace {

constexpr mode_t for_the_owner = 0600;
constexpr const char *more_room =
    "let --scratch name a folder on a disk with more room, or give more --memory";

/// Not every file system can make a file without a name. There it has one for an instant.
int open_unnamed(const std::string &folder) {
#ifdef O_TMPFILE
  const int unnamed = ::open(folder.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, for_the_owner);
  if (unnamed >= 0 || (errno != EOPNOTSUPP && errno != EISDIR && errno != EINVAL && errno != ENOENT))
    return unnamed;
#endif
  std::string name = folder + "/dovetail-scratch.XXXXXX";
  const int descriptor = ::mkostemp(name.data(), O_CLOEXEC);
  if (descriptor >= 0)
    ::unlink(name.c_str());
  return descriptor;
}

} // namespace

ScratchFile::ScratchFile(std::string folder)
    : folder_(std::move(folder)), descriptor_(open_unnamed(folder_)) {
  if (descriptor_ < 0)
    fail("cannot be used for scratch", errno,
         errno == ENOSPC || errno == EDQUOT
             ? more_room
             : "let --scratch name a folder that is there and can be written to");
}

ScratchFile::ScratchFile(ScratchFile &&other) noexcept
    : folder_(std::move(other.folder_)), descriptor_(std::exchange(other.descriptor_, -1)),
      bytes_(std::exchange(other.bytes_, 0)) {}

ScratchFile::~ScratchFile() {
  if (descriptor_ >= 0)
    ::close(descriptor_);
}

void ScratchFile::fail(const char *what, int error_number, const char *remedy) const {
  throw Error(
      {ErrorKind::output, folder_, "", std::string(what) + " (" + std::strerror(error_number) + ")", remedy});
}

std::int64_t ScratchFile::append(std::span<const std::byte> data) {
  const std::int64_t begin = bytes_;
  while (!data.empty()) {
    const ssize_t count = ::pwrite(descriptor_, data.data(), data.size(), bytes_);
    if (count < 0 && errno == EINTR)
      continue;
    if (count <= 0)
      fail("cannot take more scratch", count < 0 ? errno : ENOSPC, more_room);
    bytes_ += count;
    data = data.subspan(static_cast<std::size_t>(count));
  }
  return begin;
}

void ScratchFile::read_at(std::int64_t offset, std::span<std::byte> into) const {
  while (!into.empty()) {
    const ssize_t count = ::pread(descriptor_, into.data(), into.size(), offset);
    if (count < 0 && errno == EINTR)
      continue;
    if (count <= 0)
      fail("does not give scratch back", count < 0 ? errno : EIO,
           "let --scratch name a folder on another disk");
    offset += count;
    into = into.subspan(static_cast<std::size_t>(count));
  }
}

void ScratchFile::forget([[maybe_unused]] std::int64_t offset, [[maybe_unused]] std::int64_t bytes) const {
#ifdef FALLOC_FL_PUNCH_HOLE
  if (bytes > 0)
    ::fallocate(descriptor_, FALLOC_FL_PUNCH_HOLE | FALLOC_FL_KEEP_SIZE, offset,
                bytes); // or the end gives it
#endif
}

std::int64_t free_bytes_in(const std::string &folder) {
  struct statvfs disk {};
  if (::statvfs(folder.c_str(), &disk) != 0 || disk.f_blocks == 0)
    return -1;
  return static_cast<std::int64_t>(disk.f_bavail) * static_cast<std::int64_t>(disk.f_frsize);
}

} // namespace dovetail
