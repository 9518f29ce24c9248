#include "distributed/choose_axis.hpp"
#include "dovetail/comm/agreement.hpp"
#include "dovetail/comm/collectives.hpp"
#include "dovetail/distributed/slabs.hpp"
#include "dovetail/geometry/distributions.hpp"
#include "dovetail/geometry/split_path.hpp"
#include "dovetail/mesh/checksum.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <numeric>
#include <random>

using namespace dovetail;

namespace {

Communicator world() { return Communicator::duplicate(boost::mpi::communicator()); }
std::size_t index(std::int64_t value) { return static_cast<std::size_t>(value); }

/// Random numbers that are the same on every rank and with every library.
class Random {
public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}
  std::int64_t below(std::int64_t bound) { return static_cast<std::int64_t>(engine_() % index(bound)); }
  double unit() { return static_cast<double>(engine_() >> 11) * 0x1p-53; }

private:
  std::mt19937_64 engine_;
};

struct Input {
  std::string name;
  std::vector<Point> points;
};

Point lattice_point(std::int64_t i, std::int64_t columns) {
  const std::int64_t column = i % columns, row = i / columns;
  return {static_cast<double>(column) - 3, static_cast<double>(row)};
}

std::vector<Input> small_inputs() {
  Random random(7);
  const auto make = [](int count, auto &&point) {
    std::vector<Point> points;
    for (int i = 0; i < count; ++i)
      points.push_back(point(i));
    return points;
  };
  std::vector<Input> inputs{
      {"empty", {}},
      {"one point", {{0.5, -2}}},
      {"three points", {{3, 1}, {1, 1}, {2, 1}}},
      {"two equal points", {{1, 1}, {1, 1}}},
      {"all equal", make(60,
                         [](int) {
                           return Point{0, -1};
                         })},
      {"all x equal", make(61,
                           [&](int) {
                             return Point{2, static_cast<double>(random.below(1000))};
                           })},
      {"all y equal", make(61,
                           [&](int) {
                             return Point{static_cast<double>(random.below(40)), 5};
                           })},
      {"lattice", make(144, [&](int i) { return lattice_point((i * 55) % 144, 12); })},
      {"sorted lattice", make(144, [&](int i) { return lattice_point(i, 12); })},
      {"heavy duplicates", make(300, [&](int) { return lattice_point(random.below(15), 5); })},
      {"uniform", make(200,
                       [&](int) {
                         return Point{random.unit() - 0.5, random.unit()};
                       })},
      {"few duplicates", make(200,
                              [&](int) {
                                return Point{std::round(random.unit() * 60), std::round(random.unit() * 10)};
                              })},
      {"far and near", make(150,
                            [&](int i) {
                              const double sign = random.below(2) == 0 ? -1 : 1;
                              return Point{sign * std::ldexp(1 + random.unit(),
                                                             static_cast<int>(random.below(2000)) - 1020),
                                           i % 7 == 0 ? 0.0 : random.unit()};
                            })},
      {"one ulp apart", make(100, [&](int) {
         double x = 1e6;
         for (auto steps = random.below(9); steps > 0; --steps)
           x = std::nextafter(x, 2e6);
         return Point{x, 1 + static_cast<double>(random.below(5)) * 0x1p-52};
       })}};
  return inputs;
}

/// How an input of n points is spread: the rank of point i.
using Spread = std::function<int(std::int64_t i, std::int64_t n, int ranks)>;
const std::vector<Spread> spreads{
    [](std::int64_t i, std::int64_t n, int ranks) { return static_cast<int>(i * ranks / n); },
    [](std::int64_t, std::int64_t, int ranks) { return ranks - 1; },
    [](std::int64_t i, std::int64_t n, int ranks) { return static_cast<int>(i * ranks / n) / 2 * 2; },
    [](std::int64_t i, std::int64_t, int ranks) { return static_cast<int>((i * i + i / 3) % ranks); }};

GlobalIndex input_index_of(std::int64_t i, std::int64_t n, bool shuffled) {
  if (!shuffled)
    return i;
  std::int64_t step = 77;
  while (std::gcd(step, n) != 1)
    ++step;
  return (i * step + 3) % n;
}
/// Few values, so that there are ties among equal points.
double z_of(GlobalIndex input_index) { return static_cast<double>((input_index * 7919) % 5) - 2; }
double weight_of(GlobalIndex input_index) { return 0.25 * static_cast<double>(input_index) + 1; }

PointTable part_of(const std::vector<Point> &points, const Spread &spread, int rank, int ranks,
                   bool shuffled) {
  PointTable table;
  table.attributes = {{"z", {}}, {"weight", {}}};
  const std::int64_t n = std::ssize(points);
  for (std::int64_t i = 0; i < n; ++i)
    if (spread(i, n, ranks) == rank) {
      const GlobalIndex number = input_index_of(i, n, shuffled);
      table.points.push_back(points[index(i)]);
      table.input_index.push_back(number);
      table.attributes[0].values.push_back(z_of(number));
      table.attributes[1].values.push_back(weight_of(number));
    }
  return table;
}

/// What sort_into_slabs must find, from ordered containers.
struct Oracle {
  std::vector<Point> sites;
  std::vector<GlobalIndex> representative;
  std::vector<Duplicate> duplicates;
  std::uint64_t hash = 0;
};

Oracle oracle_of(const std::vector<Point> &points, Axis axis, DuplicateRule rule, bool shuffled) {
  std::map<std::pair<double, double>, std::vector<GlobalIndex>> equal;
  Oracle oracle;
  const std::int64_t n = std::ssize(points);
  for (std::int64_t i = 0; i < n; ++i) {
    const Point p = points[index(i)];
    const GlobalIndex number = input_index_of(i, n, shuffled);
    equal[axis == Axis::x ? std::pair(p.x, p.y) : std::pair(p.y, p.x)].push_back(number);
    oracle.hash += digest_of_point(p, z_of(number), number);
  }
  for (auto &[key, numbers] : equal) {
    std::sort(numbers.begin(), numbers.end(), [&](GlobalIndex a, GlobalIndex b) {
      const double sign = rule == DuplicateRule::lowest ? 1 : rule == DuplicateRule::highest ? -1 : 0;
      return std::pair(sign * z_of(a), a) < std::pair(sign * z_of(b), b);
    });
    for (std::size_t i = 1; i < numbers.size(); ++i)
      oracle.duplicates.push_back({numbers[i], std::ssize(oracle.sites), z_of(numbers[i])});
    oracle.sites.push_back(axis == Axis::x ? Point{key.first, key.second} : Point{key.second, key.first});
    oracle.representative.push_back(numbers[0]);
  }
  std::sort(oracle.duplicates.begin(), oracle.duplicates.end(), [](const Duplicate &a, const Duplicate &b) {
    return std::pair(a.site, a.input_index) < std::pair(b.site, b.input_index);
  });
  return oracle;
}

void expect_slabs(const Communicator &comm, const Slabs &slabs, const Oracle &oracle, int slab_count,
                  GlobalIndex points) {
  const std::int64_t n = std::ssize(oracle.sites);
  EXPECT_EQ(slabs.slab_count(), slab_count);
  if (slabs.slab_count() != slab_count)
    return;
  EXPECT_EQ(slabs.digest.points, points);
  EXPECT_EQ(slabs.digest.hash, oracle.hash);
  EXPECT_EQ(std::ssize(slabs.lines), slab_count - 1);
  for (std::int64_t s = 0; s <= slab_count; ++s) {
    const GlobalIndex before = n * s / slab_count;
    EXPECT_EQ(slabs.site_offsets[index(s)], before);
    if (s > 0 && s < slab_count) {
      const double line =
          n == 0 ? 0.0 : across(oracle.sites[index(before == 0 ? 0 : before - 1)], slabs.axis);
      EXPECT_EQ(slabs.lines[index(s - 1)], line);
    }
  }
  const std::int64_t first_slab = static_cast<std::int64_t>(slab_count) * comm.rank() / comm.size();
  const std::int64_t end_slab = static_cast<std::int64_t>(slab_count) * (comm.rank() + 1) / comm.size();
  EXPECT_EQ(slabs.first_slab, first_slab);
  EXPECT_EQ(slabs.own_slab_count, end_slab - first_slab);
  const GlobalIndex begin = n * first_slab / slab_count;
  const GlobalIndex end = n * end_slab / slab_count;
  const PointTable &own = slabs.sites;
  EXPECT_EQ(own.points, std::vector<Point>(oracle.sites.begin() + begin, oracle.sites.begin() + end));
  EXPECT_EQ(own.input_index, std::vector<GlobalIndex>(oracle.representative.begin() + begin,
                                                      oracle.representative.begin() + end));
  EXPECT_EQ(own.attributes.size(), 2u);
  for (std::size_t i = 0; i < own.input_index.size(); ++i) {
    EXPECT_EQ(own.attributes[0].values[i], z_of(own.input_index[i]));
    EXPECT_EQ(own.attributes[1].values[i], weight_of(own.input_index[i]));
  }
  std::vector<Duplicate> duplicates;
  for (const Duplicate &d : oracle.duplicates)
    if (d.site >= begin && d.site < end)
      duplicates.push_back(d);
  EXPECT_EQ(slabs.duplicates, duplicates);
}

TEST(Slabs, AreThoseOfAnOrderedMap) {
  Communicator comm = world();
  int turn = 0;
  for (const Input &input : small_inputs())
    for (const Spread &spread : spreads)
      for (const int slab_count : {comm.size(), 1, 7, 16}) {
        ++turn;
        const Axis axis = turn % 7 % 2 == 0 ? Axis::x : Axis::y;
        comm.set_chunk_bytes(turn % 3 == 0 ? 7 : 1 << 30);
        const auto rule = std::array{DuplicateRule::first, DuplicateRule::lowest,
                                     DuplicateRule::highest}[index(turn % 3 + turn / 5) % 3];
        const bool shuffled = turn % 2 == 0;
        SCOPED_TRACE(input.name + ", turn " + std::to_string(turn));
        SlabOptions options;
        options.slabs = slab_count;
        options.axis = axis == Axis::x ? AxisChoice::x : AxisChoice::y;
        options.duplicates = rule;
        const Slabs slabs =
            sort_into_slabs(comm, part_of(input.points, spread, comm.rank(), comm.size(), shuffled), options);
        EXPECT_EQ(slabs.axis, axis);
        expect_slabs(comm, slabs, oracle_of(input.points, axis, rule, shuffled), slab_count,
                     std::ssize(input.points));
      }
}

TEST(Slabs, LargerSetsOfEveryDistribution) {
  const Communicator comm = world();
  for (const Distribution distribution : all_distributions) {
    SCOPED_TRACE(std::string(distribution_name(distribution)));
    std::vector<Point> points(comm.size() <= 2 ? 60'000 : 15'000);
    generate_points({distribution, std::ssize(points), 1}, 0, points);
    SlabOptions options;
    options.slabs = 16;
    options.axis = AxisChoice::x;
    const Slabs slabs =
        sort_into_slabs(comm, part_of(points, spreads[3], comm.rank(), comm.size(), false), options);
    expect_slabs(comm, slabs, oracle_of(points, Axis::x, DuplicateRule::first, false), 16,
                 std::ssize(points));
  }
}

std::string error_of(const std::function<void()> &work) {
  try {
    work();
  } catch (const Error &error) {
    return error.what();
  }
  return "none";
}

TEST(Slabs, EqualPointsAreRefusedWhereTheyAreAnError) {
  const Communicator comm = world();
  std::vector<Point> points;
  for (int i = 0; i < 50; ++i)
    points.push_back({static_cast<double>(i), 0.1});
  SlabOptions options;
  options.duplicates = DuplicateRule::error;
  options.subject = "points.npy";
  for (const Spread &spread : spreads) {
    const auto run = [&] {
      sort_into_slabs(comm, part_of(points, spread, comm.rank(), comm.size(), false), options);
    };
    points[7] = {7, 0.1};
    points[40] = {40, 0.1};
    EXPECT_EQ(error_of(run), "none");
    points[40] = {9, 0.1};
    points[7] = {21, 0.1};
    const std::string message = error_of(run);
    for (const char *part : {"points.npy", "point 9", "point 40", "(9, 0.1)", "--duplicates"})
      EXPECT_NE(message.find(part), std::string::npos) << message;
  }
}

TEST(Slabs, PresortedPointsAreTakenAndTheFirstOffenderNamed) {
  const Communicator comm = world();
  for (const Axis axis : {Axis::x, Axis::y}) {
    std::vector<Point> points;
    for (int i = 0; i < 200; ++i) { // equal pairs, and columns of ten sites
      const int column = i / 20, row = i / 2 % 10;
      const auto across = static_cast<double>(column), along = static_cast<double>(row);
      points.push_back(axis == Axis::x ? Point{across, along} : Point{along, across});
    }
    SlabOptions options;
    options.slabs = 7;
    options.presorted = true;
    options.axis = axis == Axis::x ? AxisChoice::automatic : AxisChoice::y;
    for (std::size_t which = 0; which < 3; ++which) {
      const Spread &spread = spreads[which];
      const Slabs slabs =
          sort_into_slabs(comm, part_of(points, spread, comm.rank(), comm.size(), false), options);
      EXPECT_EQ(slabs.axis, axis);
      expect_slabs(comm, slabs, oracle_of(points, axis, DuplicateRule::first, false), 7, 200);
      // Two offenders, rank borders among the places of the first, which is named.
      for (std::size_t at = 1; at < 199; at += which == 1 ? 50 : 3) {
        std::vector<Point> wrong = points;
        wrong[at] = {-1, -1};
        wrong[199] = {-2, -2};
        const std::string message = error_of(
            [&] { sort_into_slabs(comm, part_of(wrong, spread, comm.rank(), comm.size(), false), options); });
        EXPECT_NE(message.find("point " + std::to_string(at) + ":"), std::string::npos) << message;
      }
    }
  }
}

std::size_t path_sites(const std::vector<Point> &points, Axis axis) {
  std::vector<Point> sites = points;
  std::sort(sites.begin(), sites.end(), TotalOrder{axis});
  std::size_t length = 0;
  for (std::size_t s = 1; s < 7; ++s) {
    std::vector<PathSite> all;
    for (const Point &p : points)
      all.push_back({p, 0});
    length += split_path(std::move(all), {across(sites[s * sites.size() / 7], axis), axis}).size();
  }
  return length;
}

TEST(Slabs, SampleFollowsTheSetAndNotTheRanks) {
  const Communicator comm = world();
  std::vector<std::vector<Point>> sets;
  for (const std::size_t count : {std::size_t{0}, std::size_t{1}, std::size_t{90}, std::size_t{5'000}})
    generate_points({Distribution::uniform, static_cast<GlobalIndex>(count), 4}, 0, sets.emplace_back(count));
  for (const std::size_t different : {std::size_t{90}, std::size_t{150}}) { // of five thousand
    std::vector<Point> &points = sets.emplace_back(sets[3]);
    for (std::size_t i = different; i < points.size(); ++i)
      points[i] = points[i % different];
  }
  for (const std::vector<Point> &points : sets) {
    const auto sample_of = [&](std::span<const Point> own) {
      PointSketch sketch(100);
      sketch.add(own);
      return sample_of_all(comm, std::move(sketch));
    };
    PointSketch whole(100);
    whole.add(points);
    const std::vector<Point> expected = whole.points();
    PointSketch one_by_one(100);
    for (const Point &point : points)
      one_by_one.add({&point, 1});
    EXPECT_EQ(one_by_one.points(), expected);
    std::vector<Point> distinct = points;
    std::ranges::sort(distinct, TotalOrder{Axis::x});
    distinct.erase(std::unique(distinct.begin(), distinct.end()), distinct.end());
    EXPECT_EQ(expected.size(), std::min<std::size_t>(distinct.size(), 100));
    EXPECT_EQ(sample_of(points), expected) << "every rank has all points";
    EXPECT_EQ(sample_of(comm.rank() + 1 == comm.size() ? points : std::vector<Point>()), expected)
        << "one has";
    for (const Spread &spread : spreads) {
      const PointTable part = part_of(points, spread, comm.rank(), comm.size(), false);
      EXPECT_EQ(sample_of(part.points), expected);
    }
  }
}

TEST(Slabs, AxisFollowsThePathsAndNotTheRanks) {
  const Communicator comm = world();
  const auto axis_of = [&](const std::vector<Point> &points, const Spread &spread) {
    return sort_into_slabs(comm, part_of(points, spread, comm.rank(), comm.size(), false), {}).axis;
  };
  for (const Distribution distribution : all_distributions) {
    SCOPED_TRACE(std::string(distribution_name(distribution)));
    std::vector<Point> points(20'000);
    generate_points({distribution, std::ssize(points), 3}, 0, points);
    const bool hugs = distribution == Distribution::line;
    EXPECT_EQ(axis_of(points, spreads[0]), hugs ? Axis::y : Axis::x);
    EXPECT_EQ(axis_of(points, spreads[1]), hugs ? Axis::y : Axis::x);
    if (!hugs || !comm.is_root())
      continue;
    EXPECT_GE(path_sites(points, Axis::x), 10 * path_sites(points, Axis::y));
  }
  std::vector<Point> points(3'000);
  for (std::size_t i = 0; i < points.size(); ++i)
    points[i] = {1, static_cast<double>(i * 7 % 3'000)};
  EXPECT_EQ(axis_of(points, spreads[0]), Axis::y) << "vertical line";
  for (Point &p : points)
    p = {p.y, p.x};
  EXPECT_EQ(axis_of(points, spreads[0]), Axis::x) << "horizontal line";
  // Rows of a lattice as long as the blocks of the sample must not look like one column.
  points.resize(300 * 300);
  for (std::size_t i = 0; i < points.size(); ++i)
    points[i] = lattice_point(static_cast<std::int64_t>(i), 300);
  EXPECT_EQ(axis_of(points, spreads[0]), Axis::x) << "lattice by rows";
  EXPECT_EQ(axis_of({}, spreads[0]), Axis::x);
}

TEST(Slabs, DefaultCountKeepsSlabsModerateAndRanksEven) {
  for (const int ranks : {1, 2, 3, 5, 8, 64, 1000})
    for (GlobalIndex sites = 0; sites < 20'000'000'000; sites = sites * 3 / 2 + 1) {
      const int slabs = default_slab_count(sites, ranks);
      EXPECT_GE(slabs, 1);
      if (sites >= 1'000 * static_cast<GlobalIndex>(ranks)) {
        EXPECT_EQ(slabs % ranks, 0);
        EXPECT_LE(slabs, std::max(static_cast<double>(ranks), std::sqrt(static_cast<double>(sites)) / 26));
        // Beyond, the limit by paths may come first.
        EXPECT_TRUE(sites >= 500'000'000 || sites / slabs <= 1'500'000) << sites << " on " << ranks;
      } else {
        EXPECT_LE(slabs, ranks);
      }
    }
  EXPECT_EQ(default_slab_count(10'000'000, 1), 7);
  EXPECT_EQ(default_slab_count(10'000'000, 2), 8);
}

TEST(Slabs, OptionsAreChecked) {
  const Communicator comm = world();
  SlabOptions options;
  options.slabs = -1;
  EXPECT_NE(error_of([&] { sort_into_slabs(comm, {}, options); }).find("--slabs"), std::string::npos);
}

TEST(Slabs, ProgressCanInterruptOnOneRank) {
  const Communicator comm = world();
  std::vector<Point> points(50'000);
  generate_points({Distribution::uniform, std::ssize(points), 5}, 0, points);
  SlabOptions options;
  options.progress = [&](std::string_view, double fraction) {
    EXPECT_GE(fraction, 0);
    EXPECT_LE(fraction, 1);
    if (comm.rank() == comm.size() - 1)
      throw Error({ErrorKind::usage, "", "", "interrupted", ""});
  };
  EXPECT_EQ(error_of([&] {
              sort_into_slabs(comm, part_of(points, spreads[0], comm.rank(), comm.size(), false), options);
            }),
            "interrupted");
}

} // namespace
