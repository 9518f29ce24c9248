// New numbers of a growing slab's vertices, against what they are defined to be.
#include "distributed/vertex_moves.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace dovetail::insertion {
namespace {

using Numbers = std::vector<LocalIndex>;

/// What each of own old sites and of the vertices behind them becomes, new sites taken one by one.
Numbers expected_places(const Numbers &arrivals, LocalIndex old_own, const Numbers &others) {
  Numbers places;
  for (LocalIndex v = 0; v < old_own; ++v)
    places.push_back(v + static_cast<LocalIndex>(
                             std::ranges::count_if(arrivals, [&](LocalIndex place) { return place <= v; })));
  places.insert(places.end(), others.begin(), others.end());
  return places;
}

void expect_moves(const Numbers &arrivals, LocalIndex old_own, const Numbers &others) {
  const VertexMoves moves({arrivals}, old_own, others);
  const Numbers places = expected_places(arrivals, old_own, others);
  const auto count = static_cast<LocalIndex>(places.size());
  // Every vertex in every place of a group, beside others; and a few that are no full group.
  Numbers corners;
  for (LocalIndex v = 0; v < count; ++v)
    corners.insert(corners.end(), {v, (7 * v + 1) % count, (v + 1) % count});
  const Numbers old = corners;
  const std::vector<std::size_t> behind = moves.move(corners);
  std::vector<std::size_t> expected_behind;
  for (std::size_t c = 0; c < old.size(); ++c) {
    ASSERT_EQ(corners[c], places[at(old[c])])
        << "vertex " << old[c] << " of " << count << ", " << arrivals.size() << " new";
    if (old[c] >= old_own)
      expected_behind.push_back(c);
  }
  EXPECT_EQ(behind, expected_behind);
}

TEST(VertexMoves, AreThoseOfTheSitesThatArrive) {
  std::mt19937 random(1);
  for (const LocalIndex old_own : {0, 1, 63, 64, 65, 128, 200, 1000})
    for (const unsigned count : {0U, 1U, 2U, 10U, 300U})
      for (const LocalIndex span : {1, 70, old_own + 1}) { // all at one place, in one block, anywhere
        Numbers arrivals(count);
        std::ranges::generate(arrivals, [&] {
          return static_cast<LocalIndex>(random() % static_cast<unsigned>(std::min(span, old_own + 1)));
        });
        std::ranges::sort(arrivals);
        expect_moves(arrivals, old_own, {5000, 3, 4000});
      }
}

TEST(VertexMoves, AreNoneWhereNothingArrives) {
  const VertexMoves moves({}, 500, {});
  Numbers corners{0, 70, 447, 448, 499};
  EXPECT_TRUE(moves.move(corners).empty());
  EXPECT_EQ(corners, (Numbers{0, 70, 447, 448, 499}));
}

} // namespace
} // namespace dovetail::insertion
