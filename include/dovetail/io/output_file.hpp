/// A file that all ranks write together, aside, and that appears under its name only when it is complete.
#pragma once

#include "dovetail/base/progress.hpp"
#include "dovetail/comm/communicator.hpp"

#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <vector>

namespace dovetail {

/// Local. What a name stands for once symbolic links are followed, whether or not it exists. A link that
/// leads in a circle is returned as it is; opening it fails.
std::string output_target(const std::string &path);

/// The life of an output:
///
///     OutputFile file(comm, "mesh.vtkhdf");                  // Collective: creates mesh.vtkhdf.partial
///     collectively(comm, [&] { file.write_at(offset, ...); }); // Local: each rank its own byte ranges
///     file.commit();                                         // Collective: sync, rename
///
/// A name that is a symbolic link stays one: what it leads to is replaced.
/// A file that is not committed is removed when it is destroyed, so an Error that leaves the scope on all
/// ranks cleans up after itself. What another library writes can be kept aside in the same way: let it write
/// to aside(), close it, and commit. An older file of the name stays untouched until commit replaces it.
/// A process that is killed leaves the `.partial` behind; the next run overwrites it.
///
/// Errors are of kind output: no such folder, no permission, a folder or device of this name, disk full,
/// file too large. SIGXFSZ must be ignored by the program for the last (the command does so).
class OutputFile {
public:
  /// Collective. Every rank names the same path.
  OutputFile(const Communicator &comm, std::string path);
  OutputFile(const OutputFile &) = delete;
  OutputFile &operator=(const OutputFile &) = delete;
  /// Local. The root removes what was not committed; no rank may still be writing.
  ~OutputFile();

  const std::string &path() const { return path_; }
  /// Where it is until it is committed: output_target(path()) + ".partial", in the same folder as that.
  const std::string &aside() const { return aside_; }
  /// Local. While the lock is held abandon_outputs waits. For another library that creates aside() anew:
  /// otherwise the file might come back after it has been removed for good.
  [[nodiscard]] std::unique_lock<std::mutex> keep_from_being_abandoned() const;

  /// Local: throws an Error, so call it inside `collectively`. Ranks' ranges must not overlap. Where the
  /// system can do that, waits while the disk is far behind: memory does not fill with what the disk has yet
  /// to take, and the sync at the end is a short one.
  void write_at(std::int64_t offset, std::span<const std::byte> bytes);
  /// Local. What this rank has written there.
  void read_at(std::int64_t offset, std::span<std::byte> bytes);
  /// Local. From now on write_at adds its bytes to this, which must outlive the writing; null for nobody.
  void count_into(ProgressCount *count) { count_ = count; }

  /// Collective. Brings to disk (fsync) what was written, and closes the file aside: nothing may be written
  /// afterwards. For one of many files; commit does it by itself.
  void sync();

  /// Collective. The data is on disk before the name is.
  void commit();

private:
  friend void commit_together(const Communicator &comm, std::span<const std::unique_ptr<OutputFile>> parts,
                              OutputFile &main);
  void open();
  void close() noexcept;
  void push_to_disk(std::int64_t offset, std::int64_t bytes);
  /// Collective. `for_now`: abandon_outputs takes the name back, until settle, which is Local.
  void give_name(bool for_now);
  void settle();
  void remove_older();       // Local
  void take_back() noexcept; // Local

  const Communicator &comm_;
  std::string path_;   // as the user named it, for messages
  std::string target_; // what is replaced
  std::string aside_;
  int descriptor_ = -1;
  ProgressCount *count_ = nullptr;
  struct Range {
    std::int64_t offset, bytes;
  };
  std::deque<Range> under_way_; // to the disk, the oldest first
  std::int64_t bytes_under_way_ = 0;
  bool created_ = false; // by this rank, the root, and not yet committed
};

/// Local, from any thread, while others may be using OutputFiles: for a program that must end in the middle
/// of its work, because of a signal say, where no destructor runs. Removes what this process keeps aside, and
/// parts of outputs whose main file has no name yet, and returns the names that its outputs have been given
/// so far. From then on no OutputFile of this process is created, committed or destroyed: whoever tries is
/// never returned to, so let the process end.
std::vector<std::string> abandon_outputs();

/// Collective. Commits several files that are one output: all are on disk before the first gets its name, and
/// `main`, the one that people open, gets its own last. An older main file goes before the first part comes,
/// so that whoever finds one finds the parts that belong to it, whenever the process is killed. After an
/// Error none of the names is there. parts: files of all ranks of `comm`, in the same order, or files that a
/// rank writes alone (on a communicator of its own), each rank its own.
void commit_together(const Communicator &comm, std::span<const std::unique_ptr<OutputFile>> parts,
                     OutputFile &main);

} // namespace dovetail
