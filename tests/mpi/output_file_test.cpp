// Outputs appear under their name complete or not at all, and a failure leaves nothing behind.
#include "dovetail/comm/agreement.hpp"
#include "dovetail/io/output_file.hpp"
#include "dovetail/io/points.hpp"
#include "support/refusal.hpp"
#include "support/temporary_folder.hpp"

#include <gtest/gtest.h>

#include <csignal>
#include <sys/resource.h>
#include <sys/stat.h>

using namespace dovetail;
using namespace dovetail::testing;

namespace {

Communicator world() { return Communicator::duplicate(boost::mpi::communicator()); }

PointTable some_points(const Communicator &comm, std::size_t count) {
  PointTable table;
  table.points.assign(count, {1.0 + comm.rank(), 2.0});
  table.input_index.assign(count, 0);
  return table;
}

TEST(OutputFile, OutputsThatCannotBeWritten) {
  const Communicator comm = world();
  const TemporaryFolder folder(comm);
  const PointTable table = some_points(comm, 100);
  const auto refused = [&](ErrorKind kind, const std::string &path, const std::vector<std::string> &parts) {
    expect_refused(comm, kind, path, parts, [&] { write_points(comm, table, path); });
    EXPECT_FALSE(std::filesystem::exists(path + ".partial"));
    MPI_Barrier(comm.raw());
  };
  refused(ErrorKind::usage, folder.file("a.las"), {"ends in one of .npy, .f64"});
  refused(ErrorKind::usage, folder.file("a.stl"), {"ends in one of .npy, .f64"});
  refused(ErrorKind::output, folder.file("no/such/folder/a.npy"), {"No such file", "mkdir"});
  const std::string directory = folder.file("directory.npy"), pipe = folder.file("pipe.f64"),
                    locked = folder.file("locked"), file = folder.make("file", "");
  if (comm.is_root()) {
    std::filesystem::create_directory(directory);
    EXPECT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
    std::filesystem::permissions(folder.file(""), std::filesystem::perms(0755));
    std::filesystem::create_directory(locked);
    std::filesystem::permissions(locked, std::filesystem::perms(0555));
  }
  MPI_Barrier(comm.raw());
  refused(ErrorKind::output, directory, {"Is a directory"});
  refused(ErrorKind::output, pipe, {"a pipe"});
  refused(ErrorKind::output, file + "/a.npy", {"Not a directory"});
  {
    const Unprivileged unprivileged;
    refused(ErrorKind::output, locked + "/a.npy", {"Permission denied", "where you have permission"});
  }

  PointTable with_z = table;
  with_z.attributes.push_back({"z", std::vector<double>(100)});
  expect_refused(comm, ErrorKind::usage, "a.f64", {"attribute z", ".npy"},
                 [&] { write_points(comm, with_z, "a.f64"); });
  with_z.attributes[0].name = "intensity";
  expect_refused(comm, ErrorKind::usage, "a.f64", {"attribute intensity", ".csv"},
                 [&] { write_points(comm, with_z, "a.f64"); });
}

// A full disk, played by a limit on file sizes that some ranks meet and others do not.
TEST(OutputFile, FullDisk) {
  const Communicator comm = world();
  const TemporaryFolder folder(comm);
  const auto ignored = std::signal(SIGXFSZ, SIG_IGN);
  struct rlimit before = {};
  EXPECT_EQ(::getrlimit(RLIMIT_FSIZE, &before), 0);
  for (const std::string extension : {".npy", ".f64"})
    for (const rlim_t limit : {rlim_t{0}, rlim_t{1000}, static_cast<rlim_t>(1600 * comm.size() - 8)}) {
      const std::string path = folder.make("points" + extension, "older");
      struct rlimit low = before;
      low.rlim_cur = limit;
      EXPECT_EQ(::setrlimit(RLIMIT_FSIZE, &low), 0);
      expect_refused(comm, ErrorKind::output, path, {"File too large", "ulimit -f", "byte "},
                     [&] { write_points(comm, some_points(comm, 100), path); });
      EXPECT_EQ(::setrlimit(RLIMIT_FSIZE, &before), 0);
      MPI_Barrier(comm.raw());
      EXPECT_FALSE(std::filesystem::exists(path + ".partial"));
      EXPECT_EQ(content_of(path), "older");
      MPI_Barrier(comm.raw());
    }
  std::signal(SIGXFSZ, ignored);
}

TEST(OutputFile, AppearsOnlyWhenCommitted) {
  const Communicator comm = world();
  const TemporaryFolder folder(comm);
  const std::string path = folder.make("result", "older");
  const auto byte = static_cast<std::byte>('a' + comm.rank());
  {
    OutputFile file(comm, path);
    file.write_at(comm.rank(), std::span(&byte, 1));
    MPI_Barrier(comm.raw());
    EXPECT_EQ(content_of(path), "older");
    EXPECT_TRUE(std::filesystem::exists(path + ".partial"));
    file.commit();
  }
  EXPECT_EQ(content_of(path), std::string("abcdefgh").substr(0, static_cast<std::size_t>(comm.size())));
  MPI_Barrier(comm.raw());
  EXPECT_FALSE(std::filesystem::exists(path + ".partial"));
  {
    OutputFile file(comm, path);
    file.write_at(comm.rank(), std::span(&byte, 1));
    MPI_Barrier(comm.raw());
  }
  MPI_Barrier(comm.raw());
  EXPECT_FALSE(std::filesystem::exists(path + ".partial"));
  EXPECT_EQ(content_of(path).size(), static_cast<std::size_t>(comm.size()));
}

TEST(OutputFile, HoldsWhatAnotherLibraryWrites) {
  const Communicator comm = world();
  const TemporaryFolder folder(comm);
  // A longer one that an earlier, killed run left behind.
  folder.make("result.partial", "left behind by another run");
  OutputFile file(comm, folder.file("result"));
  if (comm.is_root())
    std::ofstream(file.aside()) << "by other means";
  file.commit();
  EXPECT_EQ(content_of(folder.file("result")), "by other means");
}

// Nothing of what an earlier, killed run left behind stays, also where it was longer.
TEST(OutputFile, LeftoverIsReplaced) {
  const Communicator comm = world();
  const TemporaryFolder folder(comm);
  folder.make("result.partial", "left behind by another run");
  OutputFile file(comm, folder.file("result"));
  collectively(comm, [&] {
    if (comm.is_root())
      file.write_at(0, std::as_bytes(std::span("short", 5)));
  });
  file.commit();
  EXPECT_EQ(content_of(folder.file("result")), "short");
}

TEST(OutputFile, FollowsLinks) {
  namespace fs = std::filesystem;
  const Communicator comm = world();
  const TemporaryFolder folder(comm);
  const std::string older = folder.make("older", "older");
  if (comm.is_root()) {
    fs::create_directory(folder.file("links"));
    fs::create_symlink("../older", folder.file("links/relative"));
    fs::create_symlink(folder.file("links/relative"), folder.file("links/absolute"));
    fs::create_symlink("../new", folder.file("links/dangling"));
    fs::create_symlink("circle", folder.file("links/circle"));
  }
  MPI_Barrier(comm.raw());
  for (const char *name : {"links/absolute", "links/dangling"}) {
    OutputFile file(comm, folder.file(name));
    EXPECT_TRUE(fs::equivalent(fs::path(file.aside()).parent_path(), fs::path(older).parent_path()));
    if (comm.is_root())
      std::ofstream(file.aside()) << "newer";
    file.commit();
    EXPECT_TRUE(fs::is_symlink(folder.file(name)));
    EXPECT_EQ(content_of(folder.file(name)), "newer");
  }
  EXPECT_EQ(content_of(older), "newer");
  EXPECT_EQ(content_of(folder.file("new")), "newer");
  const std::string circle = folder.file("links/circle");
  expect_refused(comm, ErrorKind::output, circle, {"links"}, [&] { OutputFile(comm, circle); });
}

TEST(OutputFile, OneRanksFailureIsEverybodys) {
  const Communicator comm = world();
  const TemporaryFolder folder(comm);
  const std::string path = folder.file("result");
  expect_refused(comm, ErrorKind::output, path, {"the last rank has none"}, [&] {
    OutputFile file(comm, path);
    collectively(comm, [&] {
      if (comm.rank() == comm.size() - 1)
        throw Error({ErrorKind::output, path, "", "the last rank has none", "try again"});
      file.write_at(0, {});
    });
    file.commit();
  });
  MPI_Barrier(comm.raw());
  EXPECT_TRUE(std::filesystem::is_empty(folder.file("")));
}

} // namespace
