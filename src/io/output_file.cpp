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
  std::vector<std::string> named_for_now; // parts whose main file is yet to come
  std::vector<std::string> named;

  static void forget(std::vector<std::string> &files, const std::string &path) noexcept {
    const auto found = std::find(files.begin(), files.end(), path);
    if (found != files.end())
      files.erase(found);
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
    descriptor_ = ::open(aside_.c_str(), O_RDWR | O_CREAT | O_TRUNC | O_CLOEXEC, readable_and_writable);
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
  Ledger::forget(ledger().aside, aside_);
}

std::unique_lock<std::mutex> OutputFile::keep_from_being_abandoned() const {
  return std::unique_lock(ledger().mutex);
}

void OutputFile::open() {
  if (descriptor_ >= 0)
    return;
  descriptor_ = ::open(aside_.c_str(), O_RDWR | O_CLOEXEC);
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
    push_to_disk(offset, count);
    offset += count;
    bytes = bytes.subspan(static_cast<std::size_t>(count));
    if (count_ != nullptr)
      count_->add(static_cast<double>(count));
  }
}

void OutputFile::read_at(std::int64_t offset, std::span<std::byte> bytes) {
  open();
  while (!bytes.empty()) {
    const ssize_t count = ::pread(descriptor_, bytes.data(), bytes.size(), offset);
    if (count < 0 && errno == EINTR)
      continue;
    if (count <= 0)
      fail(path_, "cannot be read again while it is written", count < 0 ? errno : EIO);
    offset += count;
    bytes = bytes.subspan(static_cast<std::size_t>(count));
  }
}

void OutputFile::push_to_disk([[maybe_unused]] std::int64_t offset, [[maybe_unused]] std::int64_t bytes) {
#ifdef __linux__
  constexpr std::int64_t worth_it = std::int64_t{1} << 16, most_under_way = std::int64_t{64} << 20;
  if (bytes < worth_it)
    return;
  // Not every file system can do it; what fails for another reason fails in fsync again, unless it has been
  // said here.
  const auto push = [&](const Range &range, unsigned how) {
    if (::sync_file_range(descriptor_, range.offset, range.bytes, how) != 0 &&
        (errno == EIO || errno == ENOSPC || errno == EDQUOT))
      fail(path_, "cannot be brought to disk", errno);
  };
  under_way_.push_back({offset, bytes});
  bytes_under_way_ += bytes;
  push(under_way_.back(), SYNC_FILE_RANGE_WRITE);
  while (bytes_under_way_ > most_under_way) {
    push(under_way_.front(),
         SYNC_FILE_RANGE_WAIT_BEFORE | SYNC_FILE_RANGE_WRITE | SYNC_FILE_RANGE_WAIT_AFTER);
    bytes_under_way_ -= under_way_.front().bytes;
    under_way_.pop_front();
  }
#endif
}

void OutputFile::sync() {
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
    if (comm_.is_root())
      sync_file(aside_, path_); // what another library wrote
  });
}

void OutputFile::give_name(bool for_now) {
  collectively(comm_, [&] {
    if (!comm_.is_root())
      return;
    {
      Ledger &files = ledger();
      const std::lock_guard lock(files.mutex);
      auto &list = for_now ? files.named_for_now : files.named;
      list.push_back(for_now ? target_ : path_);
      if (std::rename(aside_.c_str(), target_.c_str()) != 0) {
        const int error_number = errno;
        list.pop_back();
        fail(path_, "cannot be given its name", error_number);
      }
      created_ = false;
      Ledger::forget(files.aside, aside_);
    }
    sync_folder_of(target_);
  });
}

void OutputFile::settle() {
  if (!comm_.is_root())
    return;
  const std::lock_guard lock(ledger().mutex);
  ledger().named.push_back(path_);
  Ledger::forget(ledger().named_for_now, target_);
}

void OutputFile::remove_older() {
  if (comm_.is_root() && ::unlink(target_.c_str()) != 0 && errno != ENOENT)
    fail(path_, "the older file cannot be removed", errno);
}

void OutputFile::take_back() noexcept {
  if (!comm_.is_root() || created_)
    return;
  const std::lock_guard lock(ledger().mutex);
  ::unlink(target_.c_str());
  Ledger::forget(ledger().named_for_now, target_);
  Ledger::forget(ledger().named, path_);
}

void OutputFile::commit() {
  sync();
  give_name(false);
}

void commit_together(const Communicator &comm, std::span<const std::unique_ptr<OutputFile>> parts,
                     OutputFile &main) {
  collectively(comm, [&] {
    for (const auto &part : parts)
      part->sync();
  });
  main.sync();
  try {
    collectively(comm, [&] { main.remove_older(); });
    collectively(comm, [&] {
      for (const auto &part : parts)
        part->give_name(true);
    });
    // From here on an interrupted run leaves parts, perhaps without a main file, but never the reverse.
    collectively(comm, [&] {
      for (const auto &part : parts)
        part->settle();
    });
    main.give_name(false);
  } catch (...) {
    for (const auto &part : parts)
      part->take_back();
    throw;
  }
}

std::vector<std::string> abandon_outputs() {
  std::unique_lock lock(ledger().mutex);
  lock.release(); // for good
  for (const std::string &file : ledger().aside)
    ::unlink(file.c_str());
  for (const std::string &file : ledger().named_for_now)
    ::unlink(file.c_str());
  return ledger().named;
}

} // namespace dovetail
