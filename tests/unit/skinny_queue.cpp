// The order of what waits to be refined, against a map of queues.
#include "mesh/skinny_queue.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <deque>
#include <limits>
#include <map>
#include <random>
#include <tuple>

namespace dovetail {
namespace {

/// Class, tile and sixteenth of the class: what is told apart.
using Rank = std::tuple<std::uint64_t, SkinnyQueue::Tile, std::uint64_t>;

Rank rank_of(double squared_edge, SkinnyQueue::Tile tile) {
  const auto bits = std::bit_cast<std::uint64_t>(squared_edge);
  return {bits >> 52, tile, bits >> 48 & 15};
}

/// Of few classes and of many, with what has no exponent of its own.
double random_squared_edge(std::mt19937 &random, int exponents) {
  switch (random() % 8) {
  case 0:
    return 0;
  case 1:
    return std::numeric_limits<double>::denorm_min();
  case 2:
    return HUGE_VAL;
  default:
    return std::ldexp(1 + static_cast<double>(random() % 64) / 64,
                      static_cast<int>(random() % static_cast<unsigned>(exponents)) - exponents / 2);
  }
}

void expect_order(std::mt19937 &random, SkinnyQueue::Tile tiles, int exponents) {
  SkinnyQueue queue(tiles);
  std::map<Rank, std::deque<LocalIndex>> expected;
  std::size_t waiting = 0;
  LocalIndex pushed = 0;
  const auto push = [&] {
    const double squared_edge = random_squared_edge(random, exponents);
    const auto tile = static_cast<SkinnyQueue::Tile>(random() % static_cast<unsigned>(tiles));
    queue.push(squared_edge, tile, {pushed, 2 * pushed});
    expected[rank_of(squared_edge, tile)].push_back(pushed++);
    ++waiting;
  };
  const auto pop = [&] {
    const SkinnyQueue::Waiting next = queue.pop([&](const SkinnyQueue::Entry &soon) {
      EXPECT_TRUE(soon.face < pushed && soon.corner == 2 * soon.face);
    });
    const auto first = expected.begin();
    ASSERT_EQ(next.entry.face, first->second.front());
    EXPECT_EQ(next.entry.corner, 2 * next.entry.face);
    EXPECT_EQ(next.tile, std::get<SkinnyQueue::Tile>(first->first));
    first->second.pop_front();
    if (first->second.empty())
      expected.erase(first);
    --waiting;
  };
  for (const unsigned pushes_of_a_hundred : {70U, 40U, 60U, 0U})
    for (int step = 0; step < 4000; ++step) {
      if (random() % 100 < pushes_of_a_hundred) {
        push();
      } else if (waiting > 0) {
        ASSERT_NO_FATAL_FAILURE(pop());
      }
      ASSERT_EQ(queue.size(), waiting);
    }
  EXPECT_TRUE(queue.empty());
}

TEST(SkinnyQueue, ShortestFirstByClassesTilesAndSteps) {
  std::mt19937 random(1);
  for (const SkinnyQueue::Tile tiles : {1, 4, 5, 70})
    for (const int exponents : {1, 3, 200})
      expect_order(random, tiles, exponents);
}

} // namespace
} // namespace dovetail
