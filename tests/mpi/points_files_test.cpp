// Reading .f64 and .npy by ranges, and writing them: the same on every number of ranks.
#include "dovetail/comm/collectives.hpp"
#include "dovetail/geometry/distributions.hpp"
#include "dovetail/io/npy.hpp"
#include "dovetail/io/points.hpp"
#include "support/temporary_folder.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

using namespace dovetail;
using dovetail::testing::Bytes;
using dovetail::testing::content_of;
using dovetail::testing::TemporaryFolder;

namespace {

Communicator world() { return Communicator::duplicate(boost::mpi::communicator()); }

struct Row {
  double x, y, z;
};

// Numbers that float32 holds exactly too.
std::vector<Row> rows(int count, int start = 0) {
  std::vector<Row> result;
  for (int i = start; i < start + count; ++i)
    result.push_back({i * 0.5, -3.0 * i, 1000.25 + i});
  return result;
}

std::string f64_of(const std::vector<Row> &points) {
  Bytes bytes;
  for (const Row &p : points)
    bytes.add(p.x).add(p.y);
  return bytes.text();
}

// The header as NumPy writes it, for any version.
std::string npy_prefix(int version, std::string dictionary) {
  Bytes bytes;
  bytes.add_text("\x93NUMPY").add(static_cast<std::uint8_t>(version)).add(std::uint8_t{0});
  const std::size_t prefix = version == 1 ? 10 : 12;
  while ((prefix + dictionary.size() + 1) % 64 != 0)
    dictionary += ' ';
  dictionary += '\n';
  if (version == 1)
    bytes.add(static_cast<std::uint16_t>(dictionary.size()));
  else
    bytes.add(static_cast<std::uint32_t>(dictionary.size()));
  return bytes.add_text(dictionary).text();
}

template <class Number>
std::string npy_of(const std::vector<Row> &points, int columns, bool fortran, int version) {
  Bytes bytes;
  bytes.add_text(npy_prefix(version, std::string("{'descr': '<f") + (sizeof(Number) == 8 ? "8" : "4") +
                                         "', 'fortran_order': " + (fortran ? "True" : "False") +
                                         ", 'shape': (" + std::to_string(points.size()) + ", " +
                                         std::to_string(columns) + "), }"));
  const auto value = [&](std::size_t row, int column) {
    return static_cast<Number>(column == 0 ? points[row].x : column == 1 ? points[row].y : points[row].z);
  };
  if (fortran)
    for (int column = 0; column < columns; ++column)
      for (std::size_t row = 0; row < points.size(); ++row)
        bytes.add(value(row, column));
  else
    for (std::size_t row = 0; row < points.size(); ++row)
      for (int column = 0; column < columns; ++column)
        bytes.add(value(row, column));
  return bytes.text();
}

// Collective. Every rank compares its part of the whole; `with_z` compares z too.
void expect_rows(const Communicator &comm, const PointTable &table, const std::vector<Row> &wanted,
                 bool with_z) {
  const auto own = static_cast<GlobalIndex>(table.points.size());
  const auto first = static_cast<std::size_t>(exclusive_scan(comm, own));
  EXPECT_EQ(all_reduce_sum(comm, own), static_cast<GlobalIndex>(wanted.size()));
  EXPECT_EQ(table.attributes.size(), with_z ? 1u : 0u);
  EXPECT_EQ(table.input_index.size(), table.points.size());
  for (std::size_t i = 0; i < table.points.size() && first + i < wanted.size(); ++i) {
    const Row &row = wanted[first + i];
    EXPECT_EQ(table.points[i], (Point{row.x, row.y}));
    EXPECT_EQ(table.input_index[i], static_cast<GlobalIndex>(first + i));
    if (with_z && table.attributes.size() == 1) {
      EXPECT_EQ(table.attributes[0].values[i], row.z);
    }
  }
  // Parts are even.
  const auto least = static_cast<GlobalIndex>(wanted.size()) / comm.size();
  EXPECT_TRUE(own == least || own == least + 1);
}

TEST(PointFiles, PairsOfDoublesWithBuffersOfEverySize) {
  const Communicator comm = world();
  const TemporaryFolder folder(comm);
  for (const int count : {0, 1, 2, 7, 100}) {
    const std::string path = folder.make("points.f64", f64_of(rows(count)));
    for (const std::int64_t buffer : {1, 15, 16, 17, 33, 160, 1 << 20}) {
      const PointInput input = read_points(comm, std::vector{path}, {.classes = {}, .buffer_bytes = buffer});
      expect_rows(comm, input.points, rows(count), false);
      EXPECT_EQ(input.records, count);
      EXPECT_EQ(input.read, count);
    }
    MPI_Barrier(comm.raw());
  }
}

TEST(PointFiles, EveryKindOfArray) {
  const Communicator comm = world();
  const TemporaryFolder folder(comm);
  for (const int columns : {2, 3})
    for (const bool fortran : {false, true})
      for (const int version : {1, 2, 3})
        for (const int count : {0, 1, 53}) {
          const std::vector<Row> wanted = rows(count);
          const std::string a = folder.make("a.npy", npy_of<double>(wanted, columns, fortran, version));
          const std::string b = folder.make("b.NPY", npy_of<float>(wanted, columns, fortran, version));
          for (const std::string &path : {a, b})
            for (const std::int64_t buffer : {1, 50, 100'000}) {
              const PointInput input =
                  read_points(comm, std::vector{path}, {.classes = {}, .buffer_bytes = buffer});
              expect_rows(comm, input.points, wanted, columns == 3);
            }
          MPI_Barrier(comm.raw());
        }
}

TEST(PointFiles, SeveralFilesCountOnAndEmptyOnesDoNotMatter) {
  const Communicator comm = world();
  const TemporaryFolder folder(comm);
  const std::vector<std::string> paths = {
      folder.make("a.f64", f64_of(rows(3, 0))),
      folder.make("empty.f64", ""),
      folder.make("b.npy", npy_of<float>(rows(11, 3), 2, false, 1)),
      folder.make("empty.npy", npy_of<double>({}, 2, false, 1)),
      folder.make("c.npy", npy_of<double>(rows(6, 14), 2, true, 2)),
      folder.make("d.f64", f64_of(rows(1, 20))),
  };
  const PointInput input = read_points(comm, paths, {.classes = {}, .buffer_bytes = 40});
  expect_rows(comm, input.points, rows(21), false);
  EXPECT_EQ(input.files.size(), 6u);
  EXPECT_EQ(input.files[4].first_index, 14);
  EXPECT_EQ(input.files[4].read, 6);
  EXPECT_EQ(input.files[5].first_index, 20);
  EXPECT_TRUE(input.absent.empty());
}

TEST(PointFiles, MissingZIsZeroAndCounted) {
  const Communicator comm = world();
  const TemporaryFolder folder(comm);
  const std::vector<std::string> paths = {folder.make("flat.f64", f64_of(rows(5, 0))),
                                          folder.make("tall.npy", npy_of<double>(rows(9, 5), 3, false, 1))};
  const PointInput input = read_points(comm, paths);
  std::vector<Row> wanted = rows(14);
  for (std::size_t i = 0; i < 5; ++i)
    wanted[i].z = 0;
  expect_rows(comm, input.points, wanted, true);
  EXPECT_EQ(input.absent.at(0).name, "z");
  EXPECT_EQ(input.absent.at(0).points, 5);
}

TEST(PointFiles, NoFiles) {
  const Communicator comm = world();
  const PointInput input = read_points(comm, std::vector<std::string>());
  EXPECT_EQ(input.records, 0);
  EXPECT_TRUE(input.points.points.empty());
}

TEST(PointFiles, MinusZeroBecomesZeroAndExtremesSurvive) {
  const Communicator comm = world();
  const TemporaryFolder folder(comm);
  const double huge = std::numeric_limits<double>::max(), tiny = std::numeric_limits<double>::denorm_min();
  Bytes bytes;
  bytes.add_text(npy_header(4, 3));
  for (const double v : {-0.0, -0.0, -0.0, huge, huge, huge, -huge, -huge, -huge, tiny, -tiny, tiny})
    bytes.add(v);
  const PointInput input = read_points(comm, std::vector{folder.make("p.npy", bytes.text())});
  const std::vector<double> &z = input.points.attributes[0].values;
  for (std::size_t i = 0; i < input.points.points.size(); ++i) {
    const Point p = input.points.points[i];
    const GlobalIndex index = input.points.input_index[i];
    const double wanted = index == 0 ? 0.0 : index == 1 ? huge : index == 2 ? -huge : tiny;
    EXPECT_EQ(std::bit_cast<std::uint64_t>(p.x), std::bit_cast<std::uint64_t>(wanted));
    EXPECT_EQ(std::bit_cast<std::uint64_t>(p.y), std::bit_cast<std::uint64_t>(index == 3 ? -tiny : wanted));
    EXPECT_EQ(std::bit_cast<std::uint64_t>(z[i]), std::bit_cast<std::uint64_t>(wanted));
  }
}

// Written by NumPy 1.24: numpy.save(file, numpy.array([[1.5, -2], [3, 4.25], [5, 6]], dtype='<f4')).
TEST(PointFiles, AFileOfNumpysOwn) {
  const Communicator comm = world();
  const TemporaryFolder folder(comm);
  std::string text = "\x93NUMPY";
  text += std::string("\x01\x00\x76\x00", 4);
  text += "{'descr': '<f4', 'fortran_order': False, 'shape': (3, 2), }";
  text += std::string(118 - 59 - 1, ' ') + "\n";
  text += std::string(
      "\x00\x00\xc0\x3f\x00\x00\x00\xc0\x00\x00\x40\x40\x00\x00\x88\x40\x00\x00\xa0\x40\x00\x00\xc0\x40", 24);
  const PointInput input = read_points(comm, std::vector{folder.make("p.npy", text)});
  expect_rows(comm, input.points, {{1.5, -2, 0}, {3, 4.25, 0}, {5, 6, 0}}, false);
}

TEST(PointFiles, OtherSpellingsOfTheSameHeader) {
  const Communicator comm = world();
  const TemporaryFolder folder(comm);
  for (const std::string dictionary :
       {"{'shape': (2, 2), 'fortran_order': False, 'descr': '<f8'}",
        "{\"descr\":\"<f8\",\"fortran_order\":False,\"shape\":(2,2)}",
        "{'descr': '<f8', 'fortran_order': False, 'shape': (2L, 2L), }",
        " { 'descr' : '<f8' , 'fortran_order' : False , 'shape' : ( 2 , 2 , ) , } "}) {
    const std::string text = npy_prefix(1, dictionary) + f64_of(rows(2));
    const PointInput input = read_points(comm, std::vector{folder.make("p.npy", text)});
    expect_rows(comm, input.points, rows(2), false);
    MPI_Barrier(comm.raw());
  }
}

// This rank's part, uneven on purpose: rank r holds as many as its turn allows.
PointTable part_of(const std::vector<Row> &all, const Communicator &comm, bool with_z) {
  PointTable table;
  if (with_z)
    table.attributes.push_back({"z", {}});
  for (std::size_t i = 0; i < all.size(); ++i) {
    // Rank 0 nothing if there are others, the last the rest.
    const int owner = std::min(comm.size() - 1, 1 + static_cast<int>(i) / 5);
    if (owner != comm.rank())
      continue;
    table.points.push_back({all[i].x, all[i].y});
    table.input_index.push_back(static_cast<GlobalIndex>(i));
    if (with_z)
      table.attributes[0].values.push_back(all[i].z);
  }
  return table;
}

TEST(PointFiles, WrittenBytesDoNotDependOnRanksOrBuffers) {
  const Communicator comm = world();
  const TemporaryFolder folder(comm);
  for (const int count : {0, 1, 37})
    for (const std::int64_t buffer : {1, 40, 1 << 20}) {
      const std::vector<Row> all = rows(count);
      write_points(comm, part_of(all, comm, false), folder.file("a.f64"), {.buffer_bytes = buffer});
      write_points(comm, part_of(all, comm, false), folder.file("b.npy"), {.buffer_bytes = buffer});
      write_points(comm, part_of(all, comm, true), folder.file("c.npy"), {.buffer_bytes = buffer});
      EXPECT_EQ(content_of(folder.file("a.f64")), f64_of(all));
      EXPECT_EQ(content_of(folder.file("b.npy")), npy_of<double>(all, 2, false, 1));
      EXPECT_EQ(content_of(folder.file("c.npy")), npy_of<double>(all, 3, false, 1));
      EXPECT_FALSE(std::filesystem::exists(folder.file("a.f64.partial")));
      EXPECT_FALSE(std::filesystem::exists(folder.file("c.npy.partial")));
      expect_rows(comm, read_points(comm, std::vector{folder.file("c.npy")}).points, all, true);
      MPI_Barrier(comm.raw());
    }
}

// The names of so many columns do not fit into a header of version 1.0.
TEST(PointFiles, ThousandsOfColumns) {
  const Communicator comm = world();
  const TemporaryFolder folder(comm);
  constexpr int columns = 5000;
  PointTable table = part_of(rows(7), comm, true);
  for (int column = 3; column < columns; ++column) {
    std::vector<double> values;
    for (const GlobalIndex point : table.input_index)
      values.push_back(static_cast<double>(column + columns * point));
    table.attributes.push_back({"attribute " + std::to_string(column), std::move(values)});
  }
  write_points(comm, table, folder.file("wide.npy"));
  const PointInput input = read_points(comm, std::vector{folder.file("wide.npy")});
  expect_rows(comm, {input.points.points, input.points.input_index, {input.points.attributes[0]}}, rows(7),
              true);
  EXPECT_EQ(input.points.attributes.size(), static_cast<std::size_t>(columns - 2));
  const Attribute &last = input.points.attributes.back();
  EXPECT_EQ(last.name, "attribute 4999");
  for (std::size_t i = 0; i < last.values.size(); ++i)
    EXPECT_EQ(last.values[i], static_cast<double>(columns - 1 + columns * input.points.input_index[i]));
}

// NumPy writes versions 1.0 and 2.0 in Latin-1 and 3.0 in UTF-8.
TEST(PointFiles, NamesInOtherAlphabets) {
  const Communicator comm = world();
  const TemporaryFolder folder(comm);
  const std::string height = "h\xc3\xb6he", name_in_latin1 = "h\xf6he", clef = "\xf0\x9d\x84\x9e";
  const auto dictionary = [](const std::string &name) {
    return "{'descr': [('x', '<f8'), ('y', '<f8'), ('" + name +
           "', '<f8')], 'fortran_order': False, 'shape': (0,)}";
  };
  struct Case {
    int version;
    std::string written, name;
  };
  for (const auto &[version, written, name] : std::vector<Case>{
           {1, name_in_latin1, height}, {2, name_in_latin1, height}, {3, height, height}, {3, clef, clef}}) {
    const std::string path = folder.make("names.npy", npy_prefix(version, dictionary(written)));
    const PointInput input = read_points(comm, std::vector{path});
    EXPECT_EQ(input.points.attributes.at(0).name, name);
    write_points(comm, input.points, folder.file("again.npy"));
    const std::string content = content_of(folder.file("again.npy"));
    EXPECT_EQ(content.substr(6, 2), std::string("\x03\0", 2));
    EXPECT_NE(content.find("'" + name + "'"), std::string::npos);
    EXPECT_EQ(read_points(comm, std::vector{folder.file("again.npy")}).points.attributes.at(0).name, name);
  }
}

TEST(PointFiles, GeneratedOnRanksIsGeneratedAtOnce) {
  const Communicator comm = world();
  const TemporaryFolder folder(comm);
  constexpr GlobalIndex n = 1001;
  const SyntheticSet set{Distribution::lidar, n, 5};
  const GlobalIndex begin = n * comm.rank() / comm.size(), end = n * (comm.rank() + 1) / comm.size();
  PointTable table;
  table.points.resize(static_cast<std::size_t>(end - begin));
  table.input_index.resize(table.points.size());
  table.attributes.push_back({"z", std::vector<double>(table.points.size())});
  generate_points(set, begin, table.points);
  generate_heights(set, begin, table.attributes[0].values);
  write_points(comm, table, folder.file("lidar.npy"));
  std::vector<Point> points(n);
  std::vector<double> heights(n);
  generate_points(set, 0, points);
  generate_heights(set, 0, heights);
  std::vector<Row> wanted;
  for (std::size_t i = 0; i < points.size(); ++i)
    wanted.push_back({points[i].x, points[i].y, heights[i]});
  expect_rows(comm, read_points(comm, std::vector{folder.file("lidar.npy")}).points, wanted, true);
}

TEST(PointFiles, Description) {
  const Communicator comm = world();
  const TemporaryFolder folder(comm);
  const std::string path = folder.make("tall.npy", npy_of<float>(rows(9), 3, true, 2));
  const PointFile file = describe_points(path);
  EXPECT_EQ(file.records, 9);
  EXPECT_EQ(file.columns.size(), 3u);
  EXPECT_EQ(file.columns[2].type, NumberType::float32);
  EXPECT_TRUE(file.by_columns);
  const auto lines = description_lines(file);
  EXPECT_EQ(lines.at(0), "format             NPY, float32, Fortran order");
  EXPECT_EQ(lines.at(1), "points             9");
  EXPECT_EQ(lines.at(2), "attributes         z");
}

} // namespace
