#include "dovetail/comm/agreement.hpp"
#include "dovetail/comm/collectives.hpp"
#include "dovetail/comm/phases.hpp"
#include "dovetail/comm/serialization.hpp"

#include <gtest/gtest.h>

#include <new>

using namespace dovetail;

namespace {

Communicator world() { return Communicator::duplicate(boost::mpi::communicator()); }

std::string message_of(const Communicator &comm, const std::optional<Problem> &problem) {
  try {
    agree(comm, problem);
  } catch (const Error &error) {
    return error.what();
  }
  return "none";
}

Problem problem_of(int rank) {
  return {ErrorKind::output, "file" + std::to_string(rank), "byte 7", std::string(5000, 'x'), "mend it"};
}

TEST(Agreement, PassesWhenNobodyHasAProblem) {
  const Communicator comm = world();
  EXPECT_EQ(message_of(comm, std::nullopt), "none");
}

TEST(Agreement, EveryRankThrowsTheProblemOfTheLowest) {
  const Communicator comm = world();
  for (unsigned failing = 1; failing < (1u << comm.size()); ++failing) {
    const bool mine = ((failing >> comm.rank()) & 1u) != 0;
    const int lowest = __builtin_ctz(failing);
    EXPECT_EQ(message_of(comm, mine ? std::optional(problem_of(comm.rank())) : std::nullopt),
              Error(problem_of(lowest)).what());
  }
}

TEST(Agreement, CollectivelyCarriesResultsAndEveryKindOfException) {
  const Communicator comm = world();
  EXPECT_EQ(collectively(comm, [&] { return comm.rank() + 5; }), comm.rank() + 5);
  const int last = comm.size() - 1;
  const auto kind_of = [&](auto &&fail) {
    try {
      collectively(comm, [&] {
        if (comm.rank() == last)
          fail();
      });
    } catch (const Error &error) {
      return std::pair(error.kind(), error.problem().what);
    }
    return std::pair(ErrorKind::usage, std::string("nothing thrown"));
  };
  EXPECT_EQ(kind_of([] {
              throw Error({ErrorKind::output, "o", "", "full", ""});
            }),
            std::pair(ErrorKind::output, std::string("full")));
  EXPECT_EQ(kind_of([] { throw std::bad_alloc(); }).first, ErrorKind::resource);
  EXPECT_EQ(kind_of([] { throw std::length_error("long"); }).first, ErrorKind::resource);
  EXPECT_EQ(kind_of([] { throw std::runtime_error("odd"); }).second, "odd");
  EXPECT_EQ(kind_of([] { throw 3; }).second, "an unknown failure");
}

TEST(Collectives, ReduceScanAndGatherNumbers) {
  const Communicator comm = world();
  const std::int64_t p = comm.size();
  const std::int64_t r = comm.rank();
  const std::int64_t large = std::int64_t{1} << 40;
  EXPECT_EQ(all_reduce_sum(comm, large + r), p * large + p * (p - 1) / 2);
  EXPECT_EQ(all_reduce_min(comm, -r), 1 - p);
  EXPECT_EQ(all_reduce_max(comm, 2.5 * static_cast<double>(r)), 2.5 * static_cast<double>(p - 1));
  EXPECT_EQ(exclusive_scan(comm, r + 1), r * (r + 1) / 2);
  EXPECT_EQ(any_of_ranks(comm, r == p - 1), true);
  EXPECT_EQ(any_of_ranks(comm, false), false);
  EXPECT_EQ(all_of_ranks(comm, r != p - 1), false);
  EXPECT_EQ(all_of_ranks(comm, true), true);
  // Unsigned numbers on both sides of half the range.
  const std::uint64_t far = ~std::uint64_t{0} - static_cast<std::uint64_t>(r);
  EXPECT_EQ(all_reduce_min(comm, r == 0 ? std::uint64_t{3} : far), 3U);
  EXPECT_EQ(all_reduce_max(comm, r == p - 1 ? far : std::uint64_t{3}),
            ~std::uint64_t{0} - static_cast<std::uint64_t>(p - 1));
  EXPECT_EQ(all_reduce_max(comm, std::vector<std::uint64_t>{far, 0, 5}),
            (std::vector<std::uint64_t>{~std::uint64_t{0}, 0, 5}));
  EXPECT_EQ(all_reduce_min(comm, r == 0 ? 3U : 0xffffffffU), 3U);
  EXPECT_EQ(all_reduce_sum(comm, std::vector<std::int64_t>{}), std::vector<std::int64_t>{});
  EXPECT_EQ(all_reduce_max(comm, std::vector<std::int64_t>{r, -r, 7}),
            (std::vector<std::int64_t>{p - 1, 0, 7}));
  EXPECT_EQ(all_reduce_min(comm, std::vector<double>{static_cast<double>(r), 1}),
            (std::vector<double>{0, 1}));
  EXPECT_EQ(all_reduce_sum(comm, std::vector<std::int64_t>{1, r}),
            (std::vector<std::int64_t>{p, p * (p - 1) / 2}));
  const auto points = all_gather(comm, Point{static_cast<double>(r), 1});
  EXPECT_EQ(std::ssize(points), p);
  for (std::size_t i = 0; i < points.size(); ++i)
    EXPECT_EQ(points[i], (Point{static_cast<double>(i), 1}));
}

/// A path with its header, as the pipeline sends them.
struct Letter {
  int from = 0;
  std::string text;
  std::vector<Point> path;
  template <class Archive> void serialize(Archive &archive, unsigned) { archive &from &text &path; }
  friend bool operator==(const Letter &, const Letter &) = default;
};

Letter letter_of(int rank) {
  Letter letter{rank, std::string(static_cast<std::size_t>(rank), 'a'), {}};
  for (int i = 0; i < 100 * (rank % 3); ++i) // none from every third rank
    letter.path.push_back({static_cast<double>(i), static_cast<double>(rank)});
  return letter;
}

TEST(Collectives, StructsTravelFromAndToEveryRoot) {
  const Communicator comm = world();
  for (int root = 0; root < comm.size(); ++root) {
    Letter letter = letter_of(comm.rank());
    broadcast(comm, letter, root);
    EXPECT_EQ(letter, letter_of(root));
    std::int64_t number = comm.rank();
    broadcast(comm, number, root);
    EXPECT_EQ(number, root);
    const std::vector<Letter> letters = gather(comm, letter_of(comm.rank()), root);
    EXPECT_EQ(std::ssize(letters), comm.rank() == root ? comm.size() : 0);
    for (std::size_t i = 0; i < letters.size(); ++i)
      EXPECT_EQ(letters[i], letter_of(static_cast<int>(i)));
  }
}

TEST(Collectives, BroadcastModelCountsOneMessageForEveryOtherRank) {
  const Communicator comm = world();
  for (int root = 0; root < comm.size(); ++root) {
    const Communicator part = world();
    double value = 1;
    broadcast(part, value, root);
    const Traffic traffic = part.traffic();
    EXPECT_EQ(all_reduce_sum(comm, traffic.messages_sent), comm.size() - 1);
    EXPECT_EQ(all_reduce_sum(comm, traffic.bytes_sent), 8 * (comm.size() - 1));
  }
}

TEST(Communicator, SplitsInHalvesDownToOneRankAndSharesTraffic) {
  const Communicator top = world();
  Communicator part = top.duplicate();
  EXPECT_EQ(&part.traffic(), &top.traffic());
  int first = 0;
  while (part.size() > 1) {
    const int left = (part.size() + 1) / 2;
    const bool right_half = part.rank() >= left;
    Communicator half = part.split(right_half ? 1 : 0);
    first += right_half ? left : 0;
    EXPECT_EQ(half.size(), right_half ? part.size() - left : left);
    EXPECT_EQ(half.rank() + first, top.rank());
    EXPECT_EQ(&half.traffic(), &top.traffic());
    EXPECT_EQ(half.chunk_bytes(), top.chunk_bytes());
    const std::int64_t before = half.traffic().messages_sent;
    EXPECT_EQ(all_reduce_min(half, top.rank()), first);
    EXPECT_EQ(top.traffic().messages_sent > before, half.size() > 1);
    part = std::move(half);
  }
  EXPECT_EQ(first, top.rank());
}

TEST(Phases, SumUpOverRanksAndRepetitions) {
  const Communicator comm = world();
  PhaseLog log(comm);
  log.begin("talk");
  all_reduce_sum(comm, 1.0);
  log.begin("compute");
  volatile double sink = 0;
  for (int i = 0; i < 2'000'000; ++i)
    sink = sink + 1;
  EXPECT_EQ(log.measure("talk", [&] { return all_reduce_sum(comm, 1.0); }), comm.size());
  log.end();
  EXPECT_EQ(log.phases().size(), 2u);
  const auto all = summarise(comm, log);
  EXPECT_EQ(all.size(), 2u);
  if (all.size() != 2)
    return;
  const int depth = comm.size() == 1 ? 0 : comm.size() == 2 ? 1 : comm.size() <= 4 ? 2 : 3;
  EXPECT_EQ(all[0].name, "talk");
  EXPECT_EQ(all[0].messages_sent, 2 * depth * comm.size());
  EXPECT_EQ(all[0].bytes_sent, 16 * depth * comm.size());
  EXPECT_EQ(all[1].name, "compute");
  EXPECT_EQ(all[1].messages_sent, 0);
  EXPECT_GT(all[1].cpu_max_s, 0);
  EXPECT_GE(all[1].cpu_sum_s, all[1].cpu_max_s);
  EXPECT_GE(all[1].wall_max_s, all[1].wall_mean_s);
  EXPECT_GE(all[1].peak_rss_max_bytes, peak_rss_bytes() > 0 ? 1'000'000 : 0);
}

} // namespace
