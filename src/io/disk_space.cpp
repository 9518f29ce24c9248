#include "disk_space.hpp"

#include "dovetail/io/input_file.hpp"

#include <fmt/format.h>

#include <cerrno>

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/statvfs.h>
#include <unistd.h>

namespace dovetail {
namespace {

[[noreturn]] void refuse(const std::string &path, std::int64_t bytes, const char *holder, std::uint64_t room,
                         const char *remedy) {
  throw Error({ErrorKind::resource,
               path,
               {},
               fmt::format("needs {} bytes, and {} leaves {}", bytes, holder, room),
               remedy});
}

} // namespace

void check_disk_space(const std::string &path, const std::string &aside, std::int64_t bytes) {
  const auto needed = static_cast<std::uint64_t>(bytes);
  rlimit limit{};
  if (::getrlimit(RLIMIT_FSIZE, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY && limit.rlim_cur < needed)
    refuse(path, bytes, "the file size limit", limit.rlim_cur, "raise the limit (ulimit -f)");
  struct statvfs disk {};
  if (::statvfs(aside.c_str(), &disk) != 0 || disk.f_blocks == 0) // some file systems do not tell
    return;
  const std::uint64_t room = static_cast<std::uint64_t>(disk.f_bavail) * disk.f_frsize;
  if (room < needed)
    refuse(path, bytes, "the disk", room, "make room, or name a file on another disk");
}

void reserve_disk_space([[maybe_unused]] const std::string &path, [[maybe_unused]] const std::string &aside,
                        [[maybe_unused]] std::int64_t bytes) {
#ifdef __linux__
  // Not posix_fallocate: where the file system has no such call, that writes into every block.
  const int descriptor = ::open(aside.c_str(), O_WRONLY | O_CLOEXEC);
  int failed = descriptor < 0 || (bytes > 0 && ::fallocate(descriptor, 0, 0, bytes) != 0) ? errno : 0;
  if (descriptor >= 0)
    ::close(descriptor);
  if (failed != 0 && failed != EOPNOTSUPP && failed != ENOSYS)
    throw Error(
        file_problem(ErrorKind::output, path, fmt::format("cannot be given its {} bytes", bytes), failed));
#endif
}

} // namespace dovetail
