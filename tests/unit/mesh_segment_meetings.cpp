// Pieces that cross and vertices beside pieces, against all pairs in exact rationals, where pieces are many,
// long and close together; and strips against their definition.
#include "mesh/segment_meetings.hpp"
#include "mesh/strips.hpp"

#include <gmpxx.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <random>

namespace dovetail {
namespace {

using Pair = std::pair<LocalIndex, LocalIndex>;

struct Pieces {
  std::vector<Point> vertices;
  std::vector<Piece> pieces;

  void add(Point a, Point b) {
    const auto first = static_cast<LocalIndex>(vertices.size());
    vertices.insert(vertices.end(), {a, b});
    pieces.push_back({first, first + 1});
  }
  Point point(LocalIndex v) const { return vertices[static_cast<std::size_t>(v)]; }
  Meetings meetings() const {
    std::vector<LocalIndex> live(pieces.size());
    std::iota(live.begin(), live.end(), 0);
    return find_meetings(vertices, pieces, live, 0, 0);
  }
};

mpq_class doubled_area(Point a, Point b, Point c) {
  const mpq_class ax(a.x), ay(a.y), bx(b.x), by(b.y), cx(c.x), cy(c.y);
  return (bx - ax) * (cy - ay) - (by - ay) * (cx - ax);
}

/// A vertex on a piece must be found, one far from it must not.
void expect_right(const Pieces &set) {
  const Meetings found = set.meetings();
  std::vector<Pair> crossings;
  for (LocalIndex i = 0; i < std::ssize(set.pieces); ++i) {
    const auto [a, b] = set.pieces[static_cast<std::size_t>(i)];
    for (LocalIndex j = i + 1; j < std::ssize(set.pieces); ++j) {
      const auto [c, d] = set.pieces[static_cast<std::size_t>(j)];
      const auto side = [&](LocalIndex p, LocalIndex q, LocalIndex r) {
        return sgn(doubled_area(set.point(p), set.point(q), set.point(r)));
      };
      if (side(a, b, c) * side(a, b, d) < 0 && side(c, d, a) * side(c, d, b) < 0)
        crossings.emplace_back(i, j);
    }
    const Point p = set.point(a), q = set.point(b);
    const double reach = 0x1p-48 * std::max({std::fabs(p.x), std::fabs(p.y), std::fabs(q.x), std::fabs(q.y)});
    for (LocalIndex v = 0; v < std::ssize(set.vertices); ++v) {
      const Point r = set.point(v);
      const bool is_end = v == a || v == b;
      const mpq_class off = abs(doubled_area(p, q, r));
      const bool in_box = std::min(p.x, q.x) <= r.x && r.x <= std::max(p.x, q.x) &&
                          std::min(p.y, q.y) <= r.y && r.y <= std::max(p.y, q.y);
      const bool is_found = std::ranges::binary_search(found.beside, Pair{i, v});
      if (!is_end && in_box && off <= mpq_class(reach / 4) * mpq_class(std::hypot(q.x - p.x, q.y - p.y))) {
        EXPECT_TRUE(is_found) << i << ' ' << v;
      }
      if (is_end || off > mpq_class(2 * reach) * mpq_class(std::fabs(q.x - p.x) + std::fabs(q.y - p.y))) {
        EXPECT_FALSE(is_found) << i << ' ' << v;
      }
    }
  }
  EXPECT_EQ(found.crossings, crossings);
  EXPECT_TRUE(std::ranges::is_sorted(found.beside));
}

/// `gap` apart, of all lengths.
Pieces hatching(int count, double gap, Point origin, double slope, std::mt19937_64 &random) {
  std::uniform_real_distribution<double> uniform;
  Pieces set;
  for (int i = 0; i < count; ++i) {
    const double from = 0.1 * uniform(random), to = 1 - 0.5 * uniform(random) * uniform(random);
    set.add({origin.x + from, origin.y + slope * from + gap * i},
            {origin.x + to, origin.y + slope * to + gap * i});
  }
  return set;
}

TEST(SegmentMeetings, HatchingsThatCrossAndDoNot) {
  std::mt19937_64 random(1);
  for (const Point origin : {Point{0, 0}, Point{1e7, -3e7}})
    for (const double slope : {1.0, 0.3, -2.0})
      // Far apart, so near that all meet by rounding, and in between.
      for (const double gap : {1e-5, 1e-9, 0x1p-50, 0x1p-52}) {
        SCOPED_TRACE(testing::Message() << origin.x << ' ' << slope << ' ' << gap);
        Pieces set = hatching(120, gap, origin, slope, random);
        set.add({origin.x + 0.4, origin.y - 1}, {origin.x + 0.5, origin.y + 2});
        for (int i = 0; i < 40; ++i) { // on pieces, beside them, in between
          const auto [a, b] = set.pieces[random() % 120];
          const Point p = set.point(a), q = set.point(b);
          const double t = static_cast<double>(random() % 1000) / 1000;
          set.vertices.push_back(
              {p.x + t * (q.x - p.x), p.y + t * (q.y - p.y) + (i % 2 == 0 ? 0 : 0.5 * gap)});
        }
        expect_right(set);
      }
}

TEST(SegmentMeetings, FansAndChevrons) {
  for (const double offset : {0.0, 1e7}) {
    SCOPED_TRACE(offset);
    Pieces fan, chevrons;
    for (int i = 0; i < 150; ++i) {
      fan.add({offset, offset + 1e-7 * i}, {offset + 1, offset + 0.3 + 1e-3 * i});
      // The tips, on both sides of a corridor, are neighbours of pieces in the other direction.
      chevrons.add({offset - 1, offset + 1e-6 * i - 1}, {offset - 1e-9, offset + 1e-6 * i});
      chevrons.add({offset + 1e-9, offset + 1e-6 * i}, {offset + 1, offset + 1e-6 * i - 1});
    }
    expect_right(fan);
    expect_right(chevrons);
  }
}

/// Bundles of which some lines cross, in all directions, with ends on a grid so that vertices are on pieces.
TEST(SegmentMeetings, Bundles) {
  std::mt19937_64 random(3);
  for (int run = 0; run < 8; ++run) {
    Pieces set;
    const auto draw = [&](double from) { return from + 0x1p-20 * static_cast<double>(random() % 60); };
    for (int i = 0; i < 120; ++i)
      set.add({draw(0), draw(0)},
              run % 2 == 0 || i % 3 == 0 ? Point{draw(1), draw(0.5)} : Point{draw(-0.7), draw(1)});
    std::vector<Point> distinct = set.vertices;
    std::ranges::sort(distinct, lexicographically_less);
    distinct.erase(std::unique(distinct.begin(), distinct.end()), distinct.end());
    for (Piece &piece : set.pieces)
      for (LocalIndex *end : {&piece.from, &piece.to})
        *end = static_cast<LocalIndex>(
            std::ranges::lower_bound(distinct, set.point(*end), lexicographically_less) - distinct.begin());
    set.vertices = distinct;
    const auto less = [](Piece p, Piece q) { return std::pair(p.from, p.to) < std::pair(q.from, q.to); };
    for (Piece &piece : set.pieces)
      if (piece.from > piece.to)
        std::swap(piece.from, piece.to);
    std::ranges::sort(set.pieces, less);
    set.pieces.erase(std::unique(set.pieces.begin(), set.pieces.end()), set.pieces.end());
    expect_right(set);
  }
}

TEST(SegmentMeetings, BeyondTheRangeOfLengths) {
  Pieces set;
  for (int i = 0; i < 40; ++i)
    set.add({-1.7e308, -1.7e308 + 1e300 * i}, {1.7e308, 1.6e308 + 1e300 * i});
  EXPECT_EQ(set.meetings().crossings.size(), 0U);
  set.add({-1.7e308, 1.7e308}, {1.7e308, -1.7e308});
  EXPECT_EQ(set.meetings().crossings.size(), 40U);
}

/// In the time that all pairs would take, the test would not end.
TEST(SegmentMeetings, ManyLinesSideBySide) {
  constexpr int many = 100000;
  Pieces hatching, fan, chevrons;
  for (int i = 0; i < many; ++i) {
    const double y = 1e-9 * i;
    hatching.add({0, y}, {1, y + 1});
    fan.add({0, y}, {1, 0.3 + 1e-5 * i});
    chevrons.add({-1, y - 1}, {-1e-3, y});
    chevrons.add({1e-3, y}, {1, y - 1});
  }
  for (const Pieces *set : {&hatching, &fan, &chevrons}) {
    const Meetings found = set->meetings();
    EXPECT_TRUE(found.crossings.empty());
    EXPECT_TRUE(found.beside.empty());
  }
}

TEST(Strips, MeetUnlessOneIsAbove) {
  std::mt19937_64 random(4);
  for (int run = 0; run < 300; ++run) {
    const unsigned range = run % 2 == 0 ? 8 : 1000;
    std::vector<Strip> strips;
    for (int i = 0; i < 20; ++i) {
      const auto draw = [&] { return static_cast<double>(random() % range); };
      const double left = draw(), right = draw();
      strips.push_back(
          {left, left + static_cast<double>(random() % 3), right, right + static_cast<double>(random() % 3)});
    }
    const std::size_t first_passive = random() % 21;
    std::vector<std::pair<std::size_t, std::size_t>> expected, found;
    const auto is_below = [](const Strip &a, const Strip &b) {
      return a.left_high < b.left_low && a.right_high < b.right_low;
    };
    for (std::size_t i = 0; i < strips.size(); ++i)
      for (std::size_t j = i + 1; j < strips.size(); ++j)
        if (i < first_passive && !is_below(strips[i], strips[j]) && !is_below(strips[j], strips[i]))
          expected.emplace_back(i, j);
    for_each_meeting(strips, first_passive,
                     [&](std::size_t i, std::size_t j) { found.emplace_back(std::minmax(i, j)); });
    std::ranges::sort(found);
    EXPECT_EQ(found, expected);
  }
}

/// What lies in order on both sides is not looked at.
TEST(Strips, VisitsAreMeetings) {
  std::vector<Strip> strips;
  for (int i = 0; i < 100000; ++i) {
    const double y = 3.0 * i;
    strips.push_back({y, y + 1, 5 * y, 5 * y + 1});
  }
  std::size_t visits = 0;
  for_each_meeting(strips, strips.size(), [&](std::size_t, std::size_t) { ++visits; });
  EXPECT_EQ(visits, 0U);
}

} // namespace
} // namespace dovetail
