#include "dovetail/io/output_file.hpp"

#include "dovetail/comm/agreement.hpp"
#include "dovetail/io/input_file.hpp"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <fcntl.h>
#include <filesystem>
#include <mutex>
#include <sys/stat.h>
#include <system_error>
#include <unistd.h>
#include <utility>

namespace dovetail {
namespace {

constexpr mode_t readable_and_writable = 0666; // less the user's umask

[[noreturn]] void fail(const std::string &path, const std::string &what, int error_number) {
  throw Error(file_problem(ErrorKind::output, path, what, error_number));
}

// Renaming over a device or a folder would destroy it, or fail at the very end.
void refuse_unless_replaceable(const std::string &path) {
  struct stat status = {};
  if (::stat(path.c_str(), &status) != 0) {
    if (errno != ENOENT)
      fail(path, "cannot be written", errno);
    return;
  }
  if (S_ISDIR(status.st_mode))
    fail(path, "cannot be written", EISDIR);
  if (!S_ISREG(status.st_mode))
    throw Error({ErrorKind::output, path, "", "is a device or a pipe, and output needs a file",
                 "name a file in a folder where you may write"});
}

void sync_file(const std::string &aside, const std::string &path) {
  const int descriptor = ::open(aside.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0)
    fail(path, "cannot be opened to bring it to disk", errno);
  const int failed = ::fsync(descriptor) != 0 ? errno : 0;
  ::close(descriptor);
  if (failed != 0)
    fail(path, "cannot be brought to disk", failed);
}

// Makes the new name outlast a power failure. The file is complete under its name whether or not this
// succeeds, and not every file system can do it or lets us, so failures do not count.
void sync_folder_of(const std::string &path) {
  const std::string folder = std::filesystem::path(path).parent_path().string();
  const int descriptor = ::open(folder.empty() ? "." : folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0)
    return;
  ::fsync(descriptor);
  ::close(descriptor);
}

// What exists on disk because of this process, for abandon_outputs. It belongs to the process and not to any
// object: whoever ends the process has no way to the objects.
struct Ledger {
  std::mutex mutex; // held while a file appears, is renamed or disappears
  std::vector<std::string> aside;
  std::vector<std::string> named;

  void forget_aside(const std::string &path) noexcept {
    const auto found = std::find(aside.begin(), aside.end(), path);
    if (found != aside.end())
      aside.erase(found);
  }
};

Ledger &ledger() {
  static Ledger *const only = new Ledger; // never destroyed: another thread may need it at the very end
  return *only;
}

} // namespace

std::string output_target(const std::string &path) {
  constexpr int longest_chain = 40; // as Linux has it
  std::filesystem::path file(path);
  std::error_code failed;
  for (int links = 0; links < longest_chain; ++links) {
    const std::filesystem::path next = std::filesystem::read_symlink(file, failed);
    if (failed) // no link, or nothing
      return file.string();
    file = file.parent_path() / next; // an absolute `next` replaces the folder
  }
  return path;
}

OutputFile::OutputFile(const Communicator &comm, std::string path)
    : comm_(comm), path_(std::move(path)), target_(output_target(path_)), aside_(target_ + ".partial") {
  collectively(comm_, [&] {
    if (!comm_.is_root())
      return;
    refuse_unless_replaceable(path_);
    refuse_unless_replaceable(aside_);
    Ledger &files = ledger();
    const std::lock_guard lock(files.mutex);
    files.aside.push_back(aside_);
    descriptor_ = ::open(aside_.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, readable_and_writable);
    if (descriptor_ < 0) {
      const int error_number = errno;
      files.aside.pop_back();
      fail(path_, "cannot be written", error_number);
    }
    created_ = true;
  });
}

OutputFile::~OutputFile() {
  close();
  if (!created_)
    return;
  const std::lock_guard lock(ledger().mutex);
  ::unlink(aside_.c_str());
  ledger().forget_aside(aside_);
}

void OutputFile::open() {
  if (descriptor_ >= 0)
    return;
  descriptor_ = ::open(aside_.c_str(), O_WRONLY | O_CLOEXEC);
  if (descriptor_ < 0)
    fail(path_, "cannot be written by every rank", errno);
}

void OutputFile::close() noexcept {
  if (descriptor_ >= 0)
    ::close(descriptor_);
  descriptor_ = -1;
}

void OutputFile::write_at(std::int64_t offset, std::span<const std::byte> bytes) {
  open();
  while (!bytes.empty()) {
    const ssize_t count = ::pwrite(descriptor_, bytes.data(), bytes.size(), offset);
    if (count < 0 && errno == EINTR)
      continue;
    if (count <= 0) {
      Problem problem =
          file_problem(ErrorKind::output, path_, "cannot be written", count < 0 ? errno : ENOSPC);
      problem.place = "byte " + std::to_string(offset);
      throw Error(std::move(problem));
    }
    offset += count;
    bytes = bytes.subspan(static_cast<std::size_t>(count));
  }
}

void OutputFile::commit() {
  // Each rank's own writes first: on a network file system only their writer can bring them to the server,
  // and learns of a full disk only now.
  collectively(comm_, [&] {
    if (descriptor_ < 0)
      return;
    if (::fsync(descriptor_) != 0)
      fail(path_, "cannot be brought to disk", errno);
    if (::close(std::exchange(descriptor_, -1)) != 0)
      fail(path_, "cannot be brought to disk", errno);
  });
  collectively(comm_, [&] {
    if (!comm_.is_root())
      return;
    sync_file(aside_, path_); // what another library wrote
    {
      Ledger &files = ledger();
      const std::lock_guard lock(files.mutex);
      files.named.push_back(path_);
      if (std::rename(aside_.c_str(), target_.c_str()) != 0) {
        const int error_number = errno;
        files.named.pop_back();
        fail(path_, "cannot be given its name", error_number);
      }
      created_ = false;
      files.forget_aside(aside_);
    }
    sync_folder_of(target_);
  });
}

std::vector<std::string> abandon_outputs() {
  std::unique_lock lock(ledger().mutex);
  lock.release(); // for good
  for (const std::string &aside : ledger().aside)
    ::unlink(aside.c_str());
  return ledger().named;
}

} // namespace dovetail
