// LAS of every version and point format, against files built byte by byte from the specification.
#include "dovetail/comm/collectives.hpp"
#include "dovetail/io/points.hpp"
#include "support/las_bytes.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <set>

using namespace dovetail;
using namespace dovetail::testing;

namespace {

Communicator world() { return Communicator::duplicate(boost::mpi::communicator()); }

bool full() {
  const char *value = std::getenv("DOVETAIL_FULL");
  return value != nullptr && std::string(value) == "1";
}

struct Wanted {
  GlobalIndex index;
  double x, y, z;
};

// Collective.
void expect_points(const Communicator &comm, const PointInput &input, const std::vector<Wanted> &wanted) {
  const auto own = static_cast<GlobalIndex>(input.points.points.size());
  const auto first = static_cast<std::size_t>(exclusive_scan(comm, own));
  EXPECT_EQ(all_reduce_sum(comm, own), static_cast<GlobalIndex>(wanted.size()));
  EXPECT_EQ(input.read, static_cast<GlobalIndex>(wanted.size()));
  EXPECT_EQ(input.points.attributes.size(), 1u);
  for (std::size_t i = 0; i < input.points.points.size() && first + i < wanted.size(); ++i) {
    const Wanted &w = wanted[first + i];
    EXPECT_EQ(input.points.input_index[i], w.index);
    EXPECT_EQ(input.points.points[i], (Point{w.x, w.y}));
    EXPECT_EQ(input.points.attributes.at(0).values.at(i), w.z);
  }
}

PointInput read_las(const Communicator &comm, const TemporaryFolder &folder, const LasFile &file,
                    const PointReading &reading = {}) {
  PointInput input = read_points(comm, std::vector{folder.make("fixture.las", las_bytes(file))}, reading);
  MPI_Barrier(comm.raw()); // before the next fixture takes its place
  return input;
}

// Raw numbers whose products with a scale of 1/64 are exact, so that the answers need no rounding.
std::vector<LasPoint> exact_points(int count) {
  std::vector<LasPoint> points;
  for (int i = 0; i < count; ++i)
    points.push_back({64 * i + 16, -32 * i - 1, 2'147'483'647 - i, i % 32, false});
  return points;
}
std::vector<Wanted> exact_answers(int count) {
  std::vector<Wanted> wanted;
  for (int i = 0; i < count; ++i)
    wanted.push_back({i, 1000.25 + i, -4.015625 - 0.5 * i, 33554431.984375 - i / 64.0});
  return wanted;
}
LasFile exact_file(int minor, int format, int count) {
  LasFile file;
  file.minor = minor;
  file.format = format;
  file.scale = {1.0 / 64, 1.0 / 64, 1.0 / 64};
  file.offset = {1000, -4, 0};
  file.points = exact_points(count);
  file.counts = format >= 6  ? LasCounts::only_64_bits
                : minor == 4 ? LasCounts::both
                             : LasCounts::only_32_bits;
  return file;
}

const std::vector<std::vector<int>> formats_of_version = {
    {0, 1}, {0, 1}, {0, 1, 2, 3}, {0, 1, 2, 3, 4, 5}, {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10}};

TEST(Las, EveryVersionAndPointFormat) {
  const Communicator comm = world();
  const TemporaryFolder folder(comm);
  const int specified[] = {20, 28, 26, 34, 57, 63, 30, 36, 38, 59, 67}; // bytes of a point, from the tables
  for (int minor = 0; minor <= 4; ++minor)
    for (const int format : formats_of_version[static_cast<std::size_t>(minor)])
      for (const bool padded : {false, true}) {
        LasFile file = exact_file(minor, format, 13);
        if (padded) {
          file.extra_bytes = 5;
          file.header_extra = 3;
          file.gap = 7;
          file.records = {{"somebody", 1, "something", "abc"},
                          {"LASF_Spec", 4, "extra", std::string(192, 'e')}};
        }
        const PointInput input = read_las(comm, folder, file, {.classes = {}, .buffer_bytes = 100});
        expect_points(comm, input, exact_answers(13));
        const PointFile &header = input.files.at(0).file;
        EXPECT_EQ(header.las.version_minor, minor);
        EXPECT_EQ(header.las.point_format, format);
        EXPECT_EQ(header.record_bytes, specified[format] + (padded ? 5 : 0));
        EXPECT_EQ(header.las.lowest, (std::array<double, 3>{10, 20, 30}));
        EXPECT_EQ(header.las.highest, (std::array<double, 3>{11, 21, 31}));
        EXPECT_TRUE(input.coordinate_system.empty());
      }
}

TEST(Las, BuffersOfEverySizeAndNoPoints) {
  const Communicator comm = world();
  const TemporaryFolder folder(comm);
  for (const int count : {0, 1, 4, 50})
    for (const std::int64_t buffer : {1, 29, 30, 31, 60, 1 << 20})
      expect_points(comm,
                    read_las(comm, folder, exact_file(4, 6, count), {.classes = {}, .buffer_bytes = buffer}),
                    exact_answers(count));
}

TEST(Las, ScaleAndOffsetInDecimals) {
  const Communicator comm = world();
  const TemporaryFolder folder(comm);
  LasFile file;
  file.scale = {0.01, -0.001, 1e-7};
  file.offset = {600000, -5.5, -0.0};
  file.points = {{12345, 7, 0}, {-1, 2'147'483'647, -2'147'483'647 - 1}, {0, 0, 0}};
  // Rounded product, then rounded sum; the shortest decimals of the doubles.
  expect_points(
      comm, read_las(comm, folder, file),
      {{0, 600123.45, -5.507, 0}, {1, 599999.99, -2147489.147, -214.7483648}, {2, 600000, -5.5, 0}});
}

TEST(Las, ProductAndSumAreRoundedSeparately) {
  const Communicator comm = world();
  const TemporaryFolder folder(comm);
  LasFile file;
  // 3 * 0.1 rounds up to 0.30000000000000004, and then minus 0.3 is 2^-54; fused it would be 2.8e-17.
  file.scale = {0.1, 0.1, 0.1};
  file.offset = {-0.3, -0.3, -0.3};
  file.points = {{3, 3, 3}};
  expect_points(comm, read_las(comm, folder, file), {{0, 0x1p-54, 0x1p-54, 0x1p-54}});
}

TEST(Las, ClassesAndWithheldPoints) {
  const Communicator comm = world();
  const TemporaryFolder folder(comm);
  for (const int format : {1, 3, 6, 10}) {
    LasFile file = exact_file(4, format, 100);
    const int classes = format <= 5 ? 32 : 256;
    for (int i = 0; i < 100; ++i) {
      file.points[static_cast<std::size_t>(i)].classification = i * 37 % classes;
      file.points[static_cast<std::size_t>(i)].withheld = i % 10 == 3;
    }
    for (const std::vector<int> &chosen : {std::vector<int>{}, {2, 9}, {0}, {31, 30}, {222, 37, 255}}) {
      std::vector<Wanted> wanted;
      GlobalIndex withheld = 0, other = 0;
      const auto answers = exact_answers(100);
      for (int i = 0; i < 100; ++i) {
        const bool selected =
            chosen.empty() || std::find(chosen.begin(), chosen.end(), i * 37 % classes) != chosen.end();
        if (i % 10 == 3)
          ++withheld;
        else if (!selected)
          ++other;
        else
          wanted.push_back(answers[static_cast<std::size_t>(i)]);
      }
      const PointInput input = read_las(comm, folder, file, {.classes = chosen, .buffer_bytes = 500});
      expect_points(comm, input, wanted);
      EXPECT_EQ(input.records, 100);
      EXPECT_EQ(input.withheld, withheld);
      EXPECT_EQ(input.other_class, other);
      EXPECT_EQ(input.files.at(0).read, static_cast<GlobalIndex>(wanted.size()));
    }
  }
}

TEST(Las, SkippedRecordsCountInTheIndexOfLaterFiles) {
  const Communicator comm = world();
  const TemporaryFolder folder(comm);
  LasFile first = exact_file(2, 0, 5);
  for (LasPoint &p : first.points)
    p.withheld = true;
  first.points[2].withheld = false;
  const std::vector<std::string> paths = {folder.make("a.las", las_bytes(first)),
                                          folder.make("b.LAS", las_bytes(exact_file(4, 7, 3)))};
  const PointInput input = read_points(comm, paths);
  auto wanted = exact_answers(3);
  for (Wanted &w : wanted)
    w.index += 5;
  wanted.insert(wanted.begin(), exact_answers(3)[2]);
  expect_points(comm, input, wanted);
  EXPECT_EQ(input.files.at(1).first_index, 5);
  EXPECT_EQ(input.withheld, 4);
}

TEST(Las, CoordinateSystemRecords) {
  const Communicator comm = world();
  const TemporaryFolder folder(comm);
  LasFile file = exact_file(4, 6, 7);
  // GeoTIFF keys: version 1.1.0, three keys: model type, projected system EPSG 2992, units.
  Bytes keys;
  for (const int word : {1, 1, 0, 3, 1024, 0, 1, 1, 3072, 0, 1, 2992, 3076, 0, 1, 9002})
    keys.add(static_cast<std::uint16_t>(word));
  file.records = {{"other", 7, "", "xx"},
                  {"LASF_Projection", 34735, "GeoTIFF keys", keys.text()},
                  {"LASF_Spec", 0, "", ""},
                  {"LASF_Projection", 34736, "doubles", std::string(16, '\x7f')}};
  file.extended_records = {{"nobody", 65535, "", std::string(70'000, 'w')},
                           {"LASF_Projection", 2112, "exactly thirty-two characters !!", "PROJCS[\"x\"]"}};
  const PointInput input = read_las(comm, folder, file);
  expect_points(comm, input, exact_answers(7));
  EXPECT_EQ(input.coordinate_system.size(), 3u);
  if (input.coordinate_system.size() == 3) {
    const auto &records = input.coordinate_system;
    EXPECT_EQ(records[0].user_id, "LASF_Projection");
    EXPECT_EQ(records[0].record_id, 34735);
    EXPECT_EQ(records[0].description, "GeoTIFF keys");
    EXPECT_EQ(std::string(records[0].bytes.begin(), records[0].bytes.end()), keys.text());
    EXPECT_EQ(records[1].record_id, 34736);
    EXPECT_EQ(records[1].bytes, std::vector<std::uint8_t>(16, 0x7f));
    EXPECT_EQ(records[2].record_id, 2112);
    EXPECT_EQ(records[2].description, "exactly thirty-two characters !!");
    EXPECT_EQ(std::string(records[2].bytes.begin(), records[2].bytes.end()), "PROJCS[\"x\"]");
    EXPECT_EQ(description_line(records[0]), "LASF_Projection 34735, 32 bytes: EPSG:2992");
    EXPECT_EQ(description_line(records[2]), "LASF_Projection 2112, 11 bytes: PROJCS[\"x\"]");
  }
  EXPECT_FALSE(input.mixed_coordinate_systems);
}

TEST(Las, CoordinateSystemsOfSeveralFiles) {
  const Communicator comm = world();
  const TemporaryFolder folder(comm);
  LasFile file = exact_file(2, 0, 2);
  const std::string none = folder.make("none.las", las_bytes(file));
  file.records = {{"LASF_Projection", 2112, "", "WKT one"}};
  const std::string one = folder.make("one.las", las_bytes(file)),
                    same = folder.make("same.las", las_bytes(file));
  file.records[0].data = "WKT two";
  const std::string two = folder.make("two.las", las_bytes(file));
  const PointInput alike = read_points(comm, std::vector{one, none, same});
  EXPECT_EQ(alike.coordinate_system.size(), 1u);
  EXPECT_FALSE(alike.mixed_coordinate_systems);
  const PointInput mixed = read_points(comm, std::vector{one, two, same});
  EXPECT_EQ(mixed.coordinate_system.size(), 2u);
  EXPECT_TRUE(mixed.mixed_coordinate_systems);
}

TEST(Las, CountsOfVersion14) {
  const Communicator comm = world();
  const TemporaryFolder folder(comm);
  for (const LasCounts counts : {LasCounts::both, LasCounts::only_64_bits, LasCounts::only_32_bits}) {
    LasFile file = exact_file(4, 1, 9);
    file.counts = counts;
    expect_points(comm, read_las(comm, folder, file), exact_answers(9));
  }
}

TEST(Las, MorePointsThanThirtyTwoBitsCount) {
  const Communicator comm = world();
  const TemporaryFolder folder(comm);
  Bytes bytes;
  bytes.add_text(las_bytes(exact_file(4, 6, 0)));
  constexpr std::uint64_t count = 5'000'000'000;
  bytes.set(247, count);
  const std::string path = folder.make("huge.las", bytes.text());
  // A file of 150 GB that takes no room: all holes.
  if (comm.is_root()) {
    std::error_code failed;
    std::filesystem::resize_file(path, 375 + count * 30, failed);
    if (!failed) {
      const PointFile file = describe_points(path);
      EXPECT_EQ(file.records, 5'000'000'000);
      EXPECT_EQ(file.file_bytes, 375 + 5'000'000'000 * 30);
      std::filesystem::resize_file(path, 375 + count * 30 - 1);
      EXPECT_THROW(describe_points(path), Error);
    }
  }
}

TEST(Las, OffsetsBeyondFourGibibytes) {
  if (!full())
    GTEST_SKIP() << "SKIPPED: reads 4.6 GB of holes; set DOVETAIL_FULL=1";
  const Communicator comm = world();
  const TemporaryFolder folder(comm);
  // The longest records there can be, one at the far end with other coordinates.
  constexpr std::int64_t record = 65535, count = 70'000;
  LasFile file = exact_file(4, 6, 0);
  file.extra_bytes = record - 30;
  Bytes bytes;
  bytes.add_text(las_bytes(file)).set(247, std::uint64_t{count});
  const std::string path = folder.make("long.las", bytes.text());
  if (comm.is_root()) {
    std::filesystem::resize_file(path, 375 + record * count);
    std::fstream stream(path, std::ios::binary | std::ios::in | std::ios::out);
    stream.seekp(375 + record * (count - 1));
    Bytes last;
    last.add(std::int32_t{64}).add(std::int32_t{128}).add(std::int32_t{192});
    stream << last.text();
  }
  MPI_Barrier(comm.raw());
  const PointInput input = read_points(comm, std::vector{path});
  EXPECT_EQ(input.read, count);
  for (std::size_t i = 0; i < input.points.points.size(); ++i) {
    const bool is_last = input.points.input_index[i] == count - 1;
    EXPECT_EQ(input.points.points[i], is_last ? (Point{1001, -2}) : (Point{1000, -4}));
  }
}

TEST(Las, SignatureBeforeThePointsOfVersion10) {
  const Communicator comm = world();
  const TemporaryFolder folder(comm);
  LasFile file = exact_file(0, 1, 6);
  file.uncounted_signature = true;
  expect_points(comm, read_las(comm, folder, file), exact_answers(6));
  file.uncounted_signature = false;
  file.gap = 2; // counted: the offset is behind it
  expect_points(comm, read_las(comm, folder, file), exact_answers(6));
}

TEST(Las, Description) {
  const Communicator comm = world();
  const TemporaryFolder folder(comm);
  LasFile file = exact_file(3, 5, 4);
  file.extra_bytes = 2;
  const auto lines = description_lines(describe_points(folder.make("p.las", las_bytes(file))));
  EXPECT_EQ(lines.at(0), "format             LAS 1.3, point format 5");
  EXPECT_EQ(lines.at(1), "points             4");
  EXPECT_EQ(lines.at(3), "x (in the header)  10 to 11");
  EXPECT_EQ(lines.at(7), "record             65 bytes, 2 of them extra");
}

TEST(Las, AutzenStadium) {
  const char *folder = std::getenv("DOVETAIL_DATA");
  const std::string path =
      std::string(folder != nullptr ? folder : DOVETAIL_SOURCE "/../shared/data") + "/autzen_trim.las";
  if (!std::filesystem::exists(path)) {
    EXPECT_FALSE(full()) << path << " is missing";
    GTEST_SKIP() << "SKIPPED: no " << path << "; set DOVETAIL_DATA";
  }
  const Communicator comm = world();
  const PointInput input = read_points(comm, std::vector{path});
  EXPECT_EQ(input.records, 110'000);
  EXPECT_EQ(input.read + input.withheld, 110'000);
  EXPECT_FALSE(input.coordinate_system.empty());
  const LasHeader &las = input.files.at(0).file.las;
  EXPECT_EQ(input.files[0].file.record_bytes, 34);
  // All points on every rank, to look for repeats and bounds.
  std::vector<double> x, y;
  for (const Point p : input.points.points) {
    x.push_back(p.x);
    y.push_back(p.y);
  }
  const auto all_x = gather(comm, x), all_y = gather(comm, y);
  if (!comm.is_root())
    return;
  std::set<std::pair<double, double>> distinct;
  Point lowest{1e300, 1e300}, highest{-1e300, -1e300};
  for (std::size_t rank = 0; rank < all_x.size(); ++rank)
    for (std::size_t i = 0; i < all_x[rank].size(); ++i) {
      const Point p{all_x[rank][i], all_y[rank][i]};
      distinct.insert({p.x, p.y});
      lowest = {std::min(lowest.x, p.x), std::min(lowest.y, p.y)};
      highest = {std::max(highest.x, p.x), std::max(highest.y, p.y)};
    }
  EXPECT_EQ(distinct.size(), 109'993u);
  EXPECT_NEAR(lowest.x, las.lowest[0], 0.005);
  EXPECT_NEAR(lowest.y, las.lowest[1], 0.005);
  EXPECT_NEAR(highest.x, las.highest[0], 0.005);
  EXPECT_NEAR(highest.y, las.highest[1], 0.005);
}

} // namespace
