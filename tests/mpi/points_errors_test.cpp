// What is wrong with an input is one message, the same on all ranks, that names file, place and remedy.
#include "dovetail/comm/collectives.hpp"
#include "dovetail/io/npy.hpp"
#include "dovetail/io/points.hpp"
#include "support/las_bytes.hpp"
#include "support/refusal.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <sys/stat.h>

using namespace dovetail;
using namespace dovetail::testing;

namespace {

constexpr double nan_value = std::numeric_limits<double>::quiet_NaN();
constexpr double infinity = std::numeric_limits<double>::infinity();

Communicator world() { return Communicator::duplicate(boost::mpi::communicator()); }

void expect_unreadable(const Communicator &comm, const std::string &path,
                       const std::vector<std::string> &parts, const PointReading &reading = {}) {
  expect_refused(comm, ErrorKind::input, path, parts, [&] { read_points(comm, std::vector{path}, reading); });
}

std::string f64_of(const std::vector<double> &values) {
  Bytes bytes;
  for (const double v : values)
    bytes.add(v);
  return bytes.text();
}

std::string npy_of(const std::string &dictionary, std::size_t data_bytes) {
  Bytes bytes;
  bytes.add_text("\x93NUMPY").add(std::uint8_t{1}).add(std::uint8_t{0});
  bytes.add(static_cast<std::uint16_t>(dictionary.size())).add_text(dictionary).add_zeros(data_bytes);
  return bytes.text();
}
const std::string good_dictionary = "{'descr': '<f8', 'fortran_order': False, 'shape': (3, 2)}";

LasFile good_las(int minor = 4, int format = 6) {
  LasFile file;
  file.minor = minor;
  file.format = format;
  file.points.resize(9);
  file.counts = LasCounts::both;
  return file;
}

TEST(PointErrors, FilesThatCannotBeOpened) {
  const Communicator comm = world();
  const TemporaryFolder folder(comm);
  for (const std::string extension : {"f64", "npy", "las"}) {
    expect_unreadable(comm, folder.file("missing." + extension), {"No such file", "check the name"});
    const std::string directory = folder.file("directory." + extension);
    const std::string pipe = folder.file("pipe." + extension);
    const std::string locked = folder.make("locked." + extension, f64_of({1, 2}));
    if (comm.is_root()) {
      std::filesystem::create_directory(directory);
      EXPECT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
      std::filesystem::permissions(folder.file(""), std::filesystem::perms(0755));
      std::filesystem::permissions(locked, std::filesystem::perms::none);
    }
    MPI_Barrier(comm.raw());
    expect_unreadable(comm, directory, {"Is a directory", "name a file"});
    expect_unreadable(comm, pipe, {"not a regular file"});
    {
      const Unprivileged unprivileged;
      expect_unreadable(comm, locked, {"Permission denied", "chmod"});
      MPI_Barrier(comm.raw());
    }
    expect_unreadable(comm, locked + "/inside." + extension, {"Not a directory"});
  }
}

TEST(PointErrors, Extensions) {
  const Communicator comm = world();
  const TemporaryFolder folder(comm);
  for (const std::string name : {"points.pdf", "points", "points.las.gz", "points.f32", ".las", ""})
    expect_unreadable(comm, name, {"known are .las, .npy, .f64, .xyz, .csv, .txt and .node"});
  expect_unreadable(comm, "a.laz", {"laszip -i a.laz -o a.las", "pdal translate a.laz a.las"});
  expect_unreadable(comm, folder.file("B.LAZ"), {"B.las"});
  // One bad file among good ones.
  const std::string good = folder.make("good.f64", f64_of({1, 2}));
  expect_refused(comm, ErrorKind::input, "bad.foo", {}, [&] {
    read_points(comm, std::vector<std::string>{good, "bad.foo"});
  });
}

TEST(PointErrors, CoordinatesThatAreNotFinite) {
  const Communicator comm = world();
  const TemporaryFolder folder(comm);
  for (const std::size_t bad : {0u, 1u, 50u, 98u, 99u})
    for (const double value : {nan_value, infinity, -infinity}) {
      std::vector<double> values(300, 1.0);
      const std::string word = std::isnan(value) ? "NaN" : "infinite";
      const auto place = [](std::size_t record, std::size_t byte) {
        return "record " + std::to_string(record) + " (counted from 0), byte " + std::to_string(byte);
      };
      values[3 * bad + 2] = value;
      const std::string table = npy_header(100, 3) + f64_of(values);
      expect_unreadable(comm, folder.make("a.npy", table),
                        {place(bad, 128 + 8 * (3 * bad + 2)), "z is " + word});
      // The same hundred and fifty pairs as .f64.
      expect_unreadable(
          comm, folder.make("a.f64", f64_of(values)),
          {place((3 * bad + 2) / 2, 8 * (3 * bad + 2)), (bad % 2 == 0 ? "x is " : "y is ") + word},
          {.classes = {}, .buffer_bytes = 48});
      // And as three columns, one after the other.
      std::string by_columns = npy_header(100, 3) + f64_of(values);
      by_columns.replace(by_columns.find("False"), 5, "True ");
      expect_unreadable(comm, folder.make("b.npy", by_columns),
                        {place((3 * bad + 2) % 100, 128 + 8 * (3 * bad + 2)), word});
    }
  // Finite coordinates whose sum is not are fine.
  const double huge = std::numeric_limits<double>::max();
  EXPECT_EQ(read_points(comm, std::vector{folder.make("huge.f64", f64_of({huge, huge}))}).read, 1);
  // A scale that takes whole numbers beyond the doubles.
  LasFile las = good_las();
  las.scale[1] = 1e305;
  las.points[7].y = 2'000'000'000;
  expect_unreadable(comm, folder.make("a.las", las_bytes(las)), {"record 7 ", "byte 589", "y is infinite"});
}

TEST(PointErrors, PairsOfDoubles) {
  const Communicator comm = world();
  const TemporaryFolder folder(comm);
  for (const std::size_t extra : {1u, 7u, 8u, 15u}) {
    const std::string path = folder.make("a.f64", f64_of({1, 2, 3, 4}) + std::string(extra, '\0'));
    expect_unreadable(comm, path, {"byte 32", std::to_string(extra) + " bytes are left over after 2 pairs"});
  }
}

TEST(PointErrors, NpyHeaders) {
  const Communicator comm = world();
  const TemporaryFolder folder(comm);
  const auto refused = [&](const std::string &bytes, const std::vector<std::string> &parts) {
    expect_unreadable(comm, folder.make("a.npy", bytes), parts);
    MPI_Barrier(comm.raw());
  };
  const auto dictionary = [&](const std::string &text, const std::vector<std::string> &parts) {
    refused(npy_of(text, 48), parts);
  };
  EXPECT_EQ(read_points(comm, std::vector{folder.make("good.npy", npy_of(good_dictionary, 48))}).read, 3);
  refused("", {"byte 0", "empty"});
  refused("PK\x03\x04 an npz archive", {"not an NPY file"});
  refused("\x93NUMPY", {"byte 6", "ends inside"});
  refused(std::string("\x93NUMPY\x01\x00\xff", 9), {"byte 9", "ends inside"});
  refused(std::string("\x93NUMPY\x04\x00\x10\x00\x00\x00", 12), {"version 4.0"});
  refused(std::string("\x93NUMPY\x01\x01\x10\x00\x00\x00", 12), {"version 1.1"});
  refused(std::string("\x93NUMPY\x02\x00\xff\xff\xff\xff", 12), {"byte 8", "4294967295 bytes"});
  refused(std::string("\x93NUMPY\x01\x00\x50\x00{'descr'", 18), {"byte 18", "ends inside"});
  refused(npy_of(good_dictionary, 47),
          {"ends here, with 2 of the 3 points", "byte " + std::to_string(10 + good_dictionary.size() + 47)});
  refused(npy_of(good_dictionary, 0), {"with 0 of the 3 points"});
  refused(npy_of(good_dictionary, 49),
          {"goes on after the 3 points", "byte " + std::to_string(10 + good_dictionary.size() + 48)});

  for (const std::string type : {">f8", "=f8", "<i8", "|S8", "<f2", "<c16", "f8", ""})
    dictionary("{'descr': '" + type + "', 'fortran_order': False, 'shape': (3, 2)}",
               {"'" + type + "'", "astype('<f8')"});
  const auto fields = [&](const std::string &descr, const std::string &shape,
                          const std::vector<std::string> &parts) {
    dictionary("{'descr': " + descr + ", 'fortran_order': False, 'shape': " + shape + "}", parts);
  };
  fields("[('x', '<f8'), ('t', '<f8')]", "(3,)", {"no fields x and y"});
  fields("[('x', '<f8'), ('y', '<f8')]", "(3, 1)", {"shape (3, 1)", "ravel"});
  fields("[('x', '<f8'), ('y', '>f8')]", "(3,)", {"'y' is of type '>f8'"});
  fields("[('x', '<f8'), ('y', '<f8'), ('c', '<i8')]", "(2,)", {"'c' is of type '<i8'"});
  fields("[('x', '<f8'), ('y', '<f8'), ('', '|V-8')]", "(2,)", {"'|V-8'"});
  fields("[('x', '<f8'), ('y', '<f8', (1,))]", "(3,)", {"malformed", "more than one number"});
  fields("[]", "(3,)", {"malformed", "no fields"});
  fields(std::string("[('x', '<f8'), ('y', '<f8'), ('\0', '<f8')]", 42), "(3,)",
         {"'?' is not UTF-8, or has control characters", "rename"});
  fields("[('x', '<f8')", "(3,)", {"malformed"});
  fields("[('x', '<f8'), ('y', '<f8')]", "(4,)", {"ends here, with 3 of the 4"});
  for (const std::string shape : {"()", "(6,)", "(3, 1)", "(1, 70000)", "(3, 2, 1)", "(0, 0)"})
    dictionary("{'descr': '<f8', 'fortran_order': False, 'shape': " + shape + "}",
               {"the shape " + shape, "(N, 2), (N, 3) or more"});
  dictionary("{'descr': '<f8', 'fortran_order': False, 'shape': (2, 70000)}", {"array.T"});
  dictionary("{'descr': '<f8', 'fortran_order': False, 'shape': (9223372036854775807, 2)}", {"too large"});
  dictionary("{'descr': '<f8', 'fortran_order': False, 'shape': (922337203685477580, 2)}",
             {"with 3 of the 922337203685477580"});
  for (const std::string malformed :
       {"",
        " ",
        "{",
        "}",
        "{}",
        "{'descr'}",
        "{'descr': }",
        "{'descr': '<f8}",
        "{'descr': '<f8', 'shape': (3, 2)}",
        "{'descr': '<f8', 'fortran_order': 0, 'shape': (3, 2)}",
        "{'descr': '<f8', 'fortran_order': False, 'shape': (3 2)}",
        "{'descr': '<f8', 'fortran_order': False, 'shape': (-3, 2)}",
        "{'descr': '<f8', 'fortran_order': False, 'shape': 3}",
        "{'descr': '<f8', 'fortran_order': False, 'shape': (3, 2)",
        "{'descr': '<f8', 'fortran_order': False, 'shape': (3, 2}",
        "{'descr': '<f8', 'fortran_order': False, 'shape': (3, 2)} x",
        "{'descr': '<f8', 'fortran_order': False 'shape': (3, 2)}",
        "{'descr': '<f8', 'descr': '<f8', 'fortran_order': False, 'shape': (3, 2)}",
        "{'descr': '<f8', 'fortran_order': False, 'shape': (3, 2), 'more': 1}",
        "{descr: '<f8', 'fortran_order': False, 'shape': (3, 2)}",
        "{,}",
        "['descr']"})
    dictionary(malformed, {"header is malformed", "numpy.save"});
  std::string with_nul = good_dictionary;
  with_nul += '\0';
  dictionary(with_nul, {"something follows"});
}

TEST(PointErrors, LasHeaders) {
  const Communicator comm = world();
  const TemporaryFolder folder(comm);
  const std::string good = las_bytes(good_las());
  const auto refused = [&](const std::string &bytes, const std::vector<std::string> &parts) {
    expect_unreadable(comm, folder.make("a.las", bytes), parts);
    MPI_Barrier(comm.raw());
  };
  const auto changed = [&](std::size_t offset, auto value) {
    Bytes bytes;
    bytes.add_text(good).set(offset, value);
    return bytes.text();
  };
  EXPECT_EQ(read_points(comm, std::vector{folder.make("good.las", good)}).read, 9);
  refused("", {"byte 0", "empty"});
  refused("LASF", {"byte 4", "ends inside"});
  refused("# x y z\n1 2 3\n4 5 6\n7 8 9\n", {"byte 0", "LASF"});
  refused(good.substr(0, 374), {"byte 374", "ends inside"});
  refused(good.substr(0, good.size() - 1),
          {"ends here, with 8 of the 9 points", "byte " + std::to_string(good.size() - 1)});
  refused(changed(24, std::uint8_t{2}), {"byte 24", "LAS 2.4"});
  refused(changed(25, std::uint8_t{5}), {"LAS 1.5"});
  refused(changed(94, std::uint16_t{374}), {"byte 94", "at least 375"});
  refused(changed(96, std::uint32_t{374}), {"byte 96", "overlap"});
  refused(changed(96, std::uint32_t{0xffffffff}), {"with 0 of the 9"});
  refused(changed(104, std::uint8_t{11}), {"byte 104", "point format 11"});
  refused(changed(104, std::uint8_t{0x86}), {"byte 104", "compressed", "laszip -i"});
  refused(changed(104, std::uint8_t{0x46}), {"compressed", folder.file("a.unpacked.las")});
  refused(changed(105, std::uint16_t{29}), {"byte 105", "29 bytes", "needs 30"});
  refused(changed(105, std::uint16_t{0}), {"byte 105", "0 bytes"});
  refused(changed(107, std::uint32_t{8}), {"byte 247", "9 points in 64 bits and 8 in 32"});
  refused(changed(107, std::uint32_t{0}).replace(247, 8, std::string(8, '\xff')),
          {"byte 247", "more than the file has bytes"});
  refused(changed(100, std::uint32_t{1}), {"variable length record 0 of 1", "byte 375"});
  for (const double scale : {0.0, nan_value, infinity})
    refused(changed(139, scale), {"byte 139", "scale of y"});
  refused(changed(171, -infinity), {"byte 171", "offset of z"});
  refused(las_bytes(good_las(3, 5)).replace(104, 1, "\x06"), {"needs LAS 1.4"});

  LasFile with_records = good_las();
  with_records.records = {{"LASF_Projection", 2112, "", "WKT"}, {"LASF_Projection", 2111, "", "WKT"}};
  with_records.extended_records = {{"LASF_Projection", 2112, "", "WKT"}};
  const std::string records = las_bytes(with_records);
  const auto changed_record = [&](std::size_t offset, auto value) {
    Bytes bytes;
    bytes.add_text(records).set(offset, value);
    return bytes.text();
  };
  refused(changed_record(100, std::uint32_t{3}), {"record 2 of 3 does not fit"});
  refused(changed_record(375 + 57 + 20, std::uint16_t{4}), {"record 1 claims 4 bytes", "byte 432"});
  refused(changed_record(235, std::uint64_t{400}), {"byte 235", "not between the points and the end"});
  refused(changed_record(235, std::uint64_t(-1)), {"byte 235"});
  refused(changed_record(243, std::uint32_t{2}), {"record 1 of 2 does not fit"});
  refused(changed_record(375 + 2 * 57 + 9 * 30 + 20, std::uint64_t(-1)),
          {"record 0 claims 18446744073709551615"});
  refused(records.substr(0, records.size() - 1), {"record 0 claims 3 bytes"});
}

// Local on every rank. Whatever the bytes, the answer is points or an Error.
TEST(PointErrors, EveryTruncationAndEveryChangedByte) {
  const Communicator comm = world();
  const TemporaryFolder folder(comm);
  const Communicator alone = Communicator::duplicate(MPI_COMM_SELF);
  LasFile las = good_las();
  las.records = {{"LASF_Projection", 2112, "", "WKT"}};
  las.extended_records = {{"LASF_Projection", 2111, "", "WKT"}};
  const std::pair<std::string, std::string> files[] = {{".las", las_bytes(las)},
                                                       {".npy", npy_of(good_dictionary, 48)}};
  for (const auto &[extension, bytes] : files) {
    const std::string path = folder.file("rank" + std::to_string(comm.rank()) + extension);
    const auto outcome = [&](const std::string &content) {
      std::ofstream(path, std::ios::binary | std::ios::trunc) << content;
      try {
        return read_points(alone, std::vector{path}).records;
      } catch (const Error &error) {
        EXPECT_EQ(error.kind(), ErrorKind::input) << error.what();
        return GlobalIndex{-1};
      }
    };
    for (std::size_t length = 0; length < bytes.size(); ++length)
      EXPECT_EQ(outcome(bytes.substr(0, length)), -1) << extension << " cut to " << length;
    const std::size_t header = std::min<std::size_t>(bytes.size(), 500);
    for (std::size_t i = 0; i < header; ++i)
      for (const int flip : {0x01, 0x80, 0xff}) {
        std::string content = bytes;
        content[i] = static_cast<char>(content[i] ^ flip);
        EXPECT_LE(outcome(content), 9);
      }
  }
}

TEST(PointErrors, Classes) {
  const Communicator comm = world();
  const TemporaryFolder folder(comm);
  const std::string las = folder.make("a.las", las_bytes(good_las()));
  const std::string pairs = folder.make("a.f64", f64_of({1, 2}));
  for (const int number : {-1, 256})
    expect_refused(comm, ErrorKind::usage, "--class", {std::to_string(number), "0 to 255"}, [&] {
      read_points(comm, std::vector{las}, {.classes = {2, number}});
    });
  expect_refused(comm, ErrorKind::usage, pairs, {"only LAS points have a class"}, [&] {
    read_points(comm, std::vector{las, pairs}, {.classes = {2}});
  });
}

} // namespace
