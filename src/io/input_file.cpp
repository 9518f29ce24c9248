#include "dovetail/io/input_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <fcntl.h>
#include <sys/stat.h>
#include <system_error>
#include <unistd.h>
#include <utility>

namespace dovetail {
namespace {

static_assert(sizeof(off_t) == 8, "files of more than 2 GiB need 64-bit offsets");

std::string input_remedy(int error_number) {
  switch (error_number) {
  case ENOENT:
  case ENOTDIR:
    return "check the name, and that every machine of the run sees the file";
  case EACCES:
  case EPERM:
    return "make it readable for you, for instance with chmod u+r";
  case EISDIR:
    return "name a file inside it";
  case EMFILE:
  case ENFILE:
    return "raise the limit of open files (ulimit -n)";
  default:
    return "check the disk or the network that the file is on";
  }
}

std::string output_remedy(int error_number) {
  switch (error_number) {
  case ENOENT:
  case ENOTDIR:
    return "make the folder first, for instance with mkdir -p";
  case EACCES:
  case EPERM:
  case EROFS:
    return "write to a folder where you have permission";
  case EISDIR:
    return "name a file, not a folder";
  case ENOSPC:
  case EDQUOT:
    return "free some space or write to another disk";
  case EFBIG:
    return "raise the limit of file sizes (ulimit -f) or write to another file system";
  case ENAMETOOLONG:
    return "choose a shorter name";
  case EMFILE:
  case ENFILE:
    return "raise the limit of open files (ulimit -n)";
  default:
    return "check the disk or the network that the file is on";
  }
}

} // namespace

Problem file_problem(ErrorKind kind, const std::string &path, const std::string &what, int error_number) {
  return {kind, path, "", fmt::format("{} ({})", what, std::generic_category().message(error_number)),
          kind == ErrorKind::output ? output_remedy(error_number) : input_remedy(error_number)};
}

InputFile::InputFile(std::string path) : path_(std::move(path)) {
  // Without O_NONBLOCK, opening a pipe that nobody writes to would wait for ever.
  descriptor_ = ::open(path_.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (descriptor_ < 0)
    throw Error(file_problem(ErrorKind::input, path_, "cannot be opened", errno));
  struct stat status = {};
  const int failed = ::fstat(descriptor_, &status) != 0 ? errno : S_ISDIR(status.st_mode) ? EISDIR : 0;
  if (failed == 0 && S_ISREG(status.st_mode)) {
    bytes_ = status.st_size;
    return;
  }
  ::close(descriptor_);
  descriptor_ = -1;
  if (failed != 0)
    throw Error(file_problem(ErrorKind::input, path_, "cannot be read", failed));
  throw Error({ErrorKind::input, path_, "",
               "is not a regular file, and every rank must read its own part of it",
               "copy the data into a file first"});
}

InputFile::InputFile(std::string name, std::span<const std::byte> contents)
    : path_(std::move(name)), bytes_(static_cast<std::int64_t>(contents.size())), contents_(contents) {}

InputFile::InputFile(InputFile &&other) noexcept
    : path_(std::move(other.path_)), bytes_(other.bytes_), descriptor_(std::exchange(other.descriptor_, -1)),
      contents_(other.contents_) {}

InputFile::~InputFile() {
  if (descriptor_ >= 0)
    ::close(descriptor_);
}

void InputFile::read_at(std::int64_t offset, std::span<std::byte> into) const {
  if (descriptor_ < 0) {
    const auto rest =
        contents_.subspan(static_cast<std::size_t>(std::clamp<std::int64_t>(offset, 0, bytes_)));
    if (into.size() > rest.size())
      refuse(bytes_, "the file ends here, before it should", "copy or make the file again");
    std::copy_n(rest.begin(), into.size(), into.begin());
    return;
  }
  while (!into.empty()) {
    const ssize_t count = ::pread(descriptor_, into.data(), into.size(), offset);
    if (count < 0 && errno == EINTR)
      continue;
    if (count < 0) {
      Problem problem = file_problem(ErrorKind::input, path_, "cannot be read", errno);
      problem.place = fmt::format("byte {}", offset);
      throw Error(std::move(problem));
    }
    if (count == 0)
      refuse(offset, "the file ends here, before it should", "copy or make the file again");
    offset += count;
    into = into.subspan(static_cast<std::size_t>(count));
  }
}

void InputFile::refuse(std::int64_t byte, const std::string &what, const std::string &remedy) const {
  throw Error({ErrorKind::input, path_, fmt::format("byte {}", byte), what, remedy});
}

} // namespace dovetail
