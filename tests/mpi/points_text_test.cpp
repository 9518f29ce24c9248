// Points as text by byte ranges: the same points, indices and attributes on every number of ranks and with
// every buffer, and text that is written the same.
#include "dovetail/comm/collectives.hpp"
#include "dovetail/comm/exchange.hpp"
#include "dovetail/io/points.hpp"
#include "support/temporary_folder.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>
#include <random>

using namespace dovetail;
using dovetail::testing::Bytes;
using dovetail::testing::content_of;
using dovetail::testing::TemporaryFolder;

namespace {

constexpr double nan_value = std::numeric_limits<double>::quiet_NaN();

Communicator world() { return Communicator::duplicate(boost::mpi::communicator()); }

// All points, on every rank: index, x, y, attributes, in one row each.
struct Whole {
  std::vector<std::string> names;
  std::vector<std::vector<double>> rows;
};

Whole whole_of(const Communicator &comm, const PointTable &table) {
  std::vector<double> flat;
  Whole whole;
  for (const Attribute &attribute : table.attributes) {
    whole.names.push_back(attribute.name);
    EXPECT_EQ(attribute.values.size(), table.points.size());
  }
  EXPECT_EQ(table.input_index.size(), table.points.size());
  for (std::size_t i = 0; i < table.points.size(); ++i) {
    flat.push_back(static_cast<double>(table.input_index[i]));
    flat.push_back(table.points[i].x);
    flat.push_back(table.points[i].y);
    for (const Attribute &attribute : table.attributes)
      flat.push_back(attribute.values[i]);
  }
  const auto all = all_gather_bulk<double>(comm, flat);
  const auto width = static_cast<std::ptrdiff_t>(3 + table.attributes.size());
  for (auto row = all.data.begin(); row != all.data.end(); row += width)
    whole.rows.emplace_back(row, row + width);
  return whole;
}

bool same(const std::vector<double> &a, const std::vector<double> &b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](double p, double q) {
    return std::bit_cast<std::uint64_t>(p) == std::bit_cast<std::uint64_t>(q) ||
           (std::isnan(p) && std::isnan(q));
  });
}

// `rows` without the index, which counts up from 0.
void expect_points(const Communicator &comm, const PointTable &table, const std::vector<std::string> &names,
                   const std::vector<std::vector<double>> &rows) {
  const Whole whole = whole_of(comm, table);
  EXPECT_EQ(whole.names, names);
  ASSERT_EQ(whole.rows.size(), rows.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    std::vector<double> wanted{static_cast<double>(i)};
    wanted.insert(wanted.end(), rows[i].begin(), rows[i].end());
    EXPECT_TRUE(same(whole.rows[i], wanted)) << "point " << i << " of " << rows.size();
  }
}

// The file is read with buffers of many sizes.
void expect_read(const Communicator &comm, const std::string &path, const std::vector<std::string> &names,
                 const std::vector<std::vector<double>> &rows) {
  SCOPED_TRACE(content_of(path).substr(0, 300));
  for (const std::int64_t buffer : {1, 23, 100, 1 << 20}) {
    const PointInput input = read_points(comm, std::vector{path}, {.classes = {}, .buffer_bytes = buffer});
    expect_points(comm, input.points, names, rows);
    EXPECT_EQ(input.records, static_cast<GlobalIndex>(rows.size()));
    EXPECT_EQ(input.read, input.records);
    EXPECT_EQ(input.files.at(0).file.records, input.records);
  }
  EXPECT_EQ(describe_points(path).records, static_cast<GlobalIndex>(rows.size()));
  MPI_Barrier(comm.raw());
}

TEST(PointText, Separators) {
  const Communicator comm = world();
  const TemporaryFolder folder(comm);
  const std::vector<std::vector<double>> flat{{1, 2}, {-3.5, 4e3}, {0.25, 1e-7}};
  const std::vector<std::vector<double>> tall{{1, 2, 3}, {-3.5, 4e3, 0}, {0.25, 1e-7, -1}};
  for (const std::string &end : std::vector<std::string>{"\n", "\r\n"})
    for (const std::string &last : std::vector<std::string>{end, std::string()}) {
      expect_read(comm, folder.make("a.xyz", "1 2" + end + "-3.5 4e3" + end + ".25 1E-07" + last), {}, flat);
      expect_read(comm, folder.make("a.csv", "1,2" + end + "-3.5, 4e3" + end + " 0.25,1e-7" + last), {},
                  flat);
      expect_read(comm, folder.make("a.TXT", "1\t2" + end + "-3.5 \t4e3" + end + "\t0.25\t1e-7\t" + last), {},
                  flat);
      expect_read(comm, folder.make("a.txt", "1;2;" + end + "-3.5;4e3;" + end + "0.25;1e-7" + last), {},
                  flat);
      expect_read(comm, folder.make("b.xyz", "1 2 3" + end + "-3.5 4e3 -0" + end + ".25 1E-07 -1" + last),
                  {"z"}, tall);
      expect_read(comm, folder.make("b.csv", "1,2,3" + end + "-3.5,4e3,0" + end + ".25,1E-07,-1" + last),
                  {"z"}, tall);
      MPI_Barrier(comm.raw());
    }
}

TEST(PointText, CommentsBlankLinesAndByteOrderMark) {
  const Communicator comm = world();
  const TemporaryFolder folder(comm);
  const std::string mark = "\xef\xbb\xbf";
  const std::vector<std::vector<double>> rows{{1, 2}, {3, 4}};
  expect_read(comm, folder.make("a.txt", mark + "1 2\n3 4\n"), {}, rows);
  expect_read(comm, folder.make("b.txt", mark + "# two points\n\n1 2 # first\n   \t\n// then\n3 4//\n#"), {},
              rows);
  expect_read(comm, folder.make("c.txt", mark + "x y\n1 2\n3 4"), {}, rows);
  expect_read(comm, folder.make("d.csv", "# x,y,z\n\n\"x\",\"y\"\n\n1,2\n# 9,9\n3,4"), {}, rows);
  for (const std::string &nothing : std::vector<std::string>{"", "\n\n", "# none\n", "x,y\n", "x,y"})
    expect_read(comm, folder.make("none.csv", nothing), {}, {});
  // Comments longer than any buffer, and than a rank's range.
  expect_read(
      comm,
      folder.make("e.txt", "#" + std::string(3000, '-') + "\n1 2\n#" + std::string(5000, '-') + "\n3 4\n"),
      {}, rows);
}

TEST(PointText, Names) {
  const Communicator comm = world();
  const TemporaryFolder folder(comm);
  expect_read(comm, folder.make("a.csv", "x,y,z,intensity\n1,2,3,4\n5,6,7,8\n"), {"z", "intensity"},
              {{1, 2, 3, 4}, {5, 6, 7, 8}});
  expect_read(comm, folder.make("b.csv", "id,X,Y,height,Z\n1,2,3,4,5\n"), {"z", "id", "height"},
              {{2, 3, 5, 1, 4}});
  // z comes first in the table of points.
  expect_read(comm, folder.make("c.txt", "Easting  Northing  Point\n1 2 3\n"), {"Point"}, {{1, 2, 3}});
  expect_read(comm, folder.make("d.txt", "x\ty\tpoint number\n1\t2\t3\n"), {"point number"}, {{1, 2, 3}});
  expect_read(comm, folder.make("e.csv", ",x,y,m/s,m/s,input_index,.\n0,1,2,3,4,5,6\n"),
              {"column 1", "m_s", "column 5", "column 6", "column 7"}, {{1, 2, 0, 3, 4, 5, 6}});
  expect_read(comm, folder.make("f.csv", "x;y;\"a;b\";c\n1;2;3;\n1;2;;nan\n"), {"a;b", "c"},
              {{1, 2, 3, nan_value}, {1, 2, nan_value, nan_value}});
  expect_read(comm, folder.make("g.xyz", "1 2 3 4 5\n"), {"z", "column 4", "column 5"}, {{1, 2, 3, 4, 5}});
}

std::vector<std::vector<double>> random_rows(std::size_t count, std::size_t width, unsigned seed) {
  std::mt19937_64 random(seed);
  std::vector<std::vector<double>> rows(count, std::vector<double>(width));
  for (auto &row : rows)
    for (double &value : row)
      do {
        const std::uint64_t raw = random();
        value = raw % 4 == 0   ? std::bit_cast<double>(raw)
                : raw % 4 == 1 ? static_cast<double>(raw % 1000)
                : raw % 4 == 2 ? static_cast<double>(raw % 2'000'000'000'000) / (raw % 8 < 4 ? -1e3 : 1e8)
                               : std::ldexp(static_cast<double>(raw >> 11), -40);
      } while (!std::isfinite(value));
  return rows;
}

// This rank's rows, uneven on purpose: rank 0 has none if there are others.
PointTable part_of(const Communicator &comm, const std::vector<std::vector<double>> &rows,
                   const std::vector<std::string> &names) {
  PointTable table;
  for (const std::string &name : names)
    table.attributes.push_back({name, {}});
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (std::min(comm.size() - 1, 1 + static_cast<int>(i) / 9) != comm.rank())
      continue;
    table.points.push_back({rows[i][0], rows[i][1]});
    table.input_index.push_back(static_cast<GlobalIndex>(i));
    for (std::size_t a = 0; a < names.size(); ++a)
      table.attributes[a].values.push_back(rows[i][2 + a]);
  }
  return table;
}

TEST(PointText, WrittenReadsBackBitByBit) {
  const Communicator comm = world();
  const TemporaryFolder folder(comm);
  const std::vector<std::string> names{"z", "a, b", "marker"};
  auto rows = random_rows(60, 5, 5);
  rows[17][3] = nan_value;
  for (std::size_t i = 0; i < rows.size(); ++i)
    rows[i][4] = static_cast<double>(i) * 1e5;
  const PointTable part = part_of(comm, rows, names);
  for (const std::string &extension : std::vector<std::string>{"npy", "csv", "xyz", "txt", "node"}) {
    const std::string path = folder.file("a." + extension);
    std::string first;
    for (const std::int64_t buffer : {1, 300, 1 << 20})
      for (const std::int64_t kept : {0, 700, 1 << 20}) {
        write_points(comm, part, path, {.buffer_bytes = buffer, .kept_bytes = kept});
        if (first.empty())
          first = content_of(path);
        EXPECT_EQ(content_of(path), first);
        MPI_Barrier(comm.raw());
      }
    // One rank alone writes the same.
    const Communicator alone = comm.split(comm.rank());
    const std::string own = folder.file(std::to_string(comm.rank()) + "." + extension);
    write_points(alone, part_of(alone, rows, names), own);
    EXPECT_EQ(content_of(own), first);
    const bool keeps_names = extension == "npy" || extension == "csv";
    expect_read(comm, path,
                keeps_names           ? names
                : extension == "node" ? std::vector<std::string>{"attribute 1", "attribute 2", "marker"}
                                      : std::vector<std::string>{"z", "column 4", "column 5"},
                rows);
  }
  EXPECT_EQ(content_of(folder.file("a.node")).substr(0, 9), "60 2 2 1\n");
}

TEST(PointText, ManyPointsOnManyRanks) {
  const Communicator comm = world();
  const TemporaryFolder folder(comm);
  for (const std::size_t count : {1u, 2u, 7u, 500u}) {
    const auto rows = random_rows(count, 2, static_cast<unsigned>(count));
    write_points(comm, part_of(comm, rows, {}), folder.file("a.xyz"));
    write_points(comm, part_of(comm, rows, {}), folder.file("a.node"));
    expect_read(comm, folder.file("a.xyz"), {}, rows);
    expect_read(comm, folder.file("a.node"), {}, rows);
  }
}

TEST(PointText, Vertices) {
  const Communicator comm = world();
  const TemporaryFolder folder(comm);
  const std::vector<std::vector<double>> rows{{0.5, 1}, {2, 3}, {4, 5}};
  expect_read(comm, folder.make("a.node", "3 2 0 0\n0 0.5 1\n1 2 3\n2 4 5\n"), {}, rows);
  expect_read(comm, folder.make("b.node", "# c\n\n3  2  0  0 # h\r\n\r\n 1 .5 1\r\n# c\r\n 2 2 3\r\n 3 4 5"),
              {}, rows);
  expect_read(comm, folder.make("c.node", "3\n1 0.5 1\n2 2 3\n3 4 5\n# made by hand\n"), {}, rows);
  expect_read(comm, folder.make("d.node", "2 2 2 1\n1 0.5 1 -7 8e-1 1\n2 2 3 9 10 0\n"),
              {"attribute 1", "attribute 2", "marker"}, {{0.5, 1, -7, 0.8, 1}, {2, 3, 9, 10, 0}});
  expect_read(comm, folder.make("e.node", "0 2 1 1\n"), {"attribute 1", "marker"}, {});
}

TEST(PointText, SeveralFilesOfManyKinds) {
  const Communicator comm = world();
  const TemporaryFolder folder(comm);
  std::string lines = "x,y,weight\n";
  std::vector<std::vector<double>> wanted;
  for (int i = 0; i < 40; ++i) {
    lines += std::to_string(i) + ".25," + std::to_string(7 * i) + "," + std::to_string(i % 3) + "\n";
    wanted.push_back({i + 0.25, 7.0 * i, 0, static_cast<double>(i % 3), nan_value});
  }
  Bytes pairs;
  for (int i = 0; i < 30; ++i) {
    pairs.add(i * 1.0).add(i * 2.0);
    wanted.push_back({i * 1.0, i * 2.0, 0, nan_value, nan_value});
  }
  wanted.push_back({1, 2, 3, nan_value, nan_value});
  wanted.push_back({4, 5, 0, nan_value, 6});
  const std::vector<std::string> paths{folder.make("a.csv", lines), folder.make("b.f64", pairs.text()),
                                       folder.make("empty.txt", "# nothing\n"),
                                       folder.make("c.xyz", "1 2 3\n"),
                                       folder.make("d.node", "1 2 0 1\n1 4 5 6\n")};
  for (const std::int64_t buffer : {1, 50, 1 << 20}) {
    const PointInput input = read_points(comm, paths, {.classes = {}, .buffer_bytes = buffer});
    expect_points(comm, input.points, {"z", "weight", "marker"}, wanted);
    ASSERT_EQ(input.absent.size(), 3u);
    EXPECT_EQ(input.absent[0].points, 71);
    EXPECT_EQ(input.absent[1].name, "weight");
    EXPECT_EQ(input.absent[1].points, 32);
    EXPECT_EQ(input.absent[2].points, 71);
    EXPECT_EQ(input.files[1].first_index, 40);
    EXPECT_EQ(input.files[4].first_index, 71);
    EXPECT_EQ(input.read, 72);
  }
}

TEST(PointText, ArraysWithMoreColumns) {
  const Communicator comm = world();
  const TemporaryFolder folder(comm);
  const auto array = [](const std::string &descr, const std::string &shape, const std::string &data) {
    std::string header = "{'descr': " + descr + ", 'fortran_order': False, 'shape': " + shape + "}\n";
    Bytes bytes;
    bytes.add_text("\x93NUMPY").add(std::uint8_t{1}).add(std::uint8_t{0});
    bytes.add(static_cast<std::uint16_t>(header.size())).add_text(header).add_text(data);
    return bytes.text();
  };
  Bytes rows, records;
  std::vector<std::vector<double>> of_rows, of_records;
  for (int i = 0; i < 25; ++i) {
    const auto n = static_cast<float>(i);
    rows.add(n).add(n + 0.5f).add(-n).add(i == 3 ? std::numeric_limits<float>::quiet_NaN() : n).add(2 * n);
    of_rows.push_back({n, n + 0.5, 0.0 - n, i == 3 ? nan_value : n, 2 * n});
    records.add(static_cast<std::uint16_t>(i + 60000))
        .add_zeros(2)
        .add(i * 0.5)
        .add(static_cast<std::int8_t>(-i));
    records.add(n).add(std::int32_t{-1000 * i});
    of_records.push_back({n, i * 0.5, 0.0 - 1000.0 * i, i + 60000.0, static_cast<double>(-i)});
  }
  expect_read(comm, folder.make("a.npy", array("'<f4'", "(25, 5)", rows.text())),
              {"z", "column 4", "column 5"}, of_rows);
  expect_read(
      comm,
      folder.make("b.npy", array("[('class', '<u2'), ('', '|V2'), ('y', '<f8'), ('t/u', '|i1'), ('X', "
                                 "'<f4'), ('Z', '<i4')]",
                                 "(25,)", records.text())),
      {"z", "class", "t_u"}, of_records);
}

} // namespace
