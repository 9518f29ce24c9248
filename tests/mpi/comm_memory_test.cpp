// One rank lacks the memory for what the others send: all of them hear the same, and nobody waits for ever.
#include "dovetail/comm/exchange.hpp"
#include "support/failing_allocation.hpp"

#include <boost/mpi/communicator.hpp>
#include <gtest/gtest.h>

#include <functional>
#include <numeric>

namespace dovetail::testing {
namespace {

constexpr std::size_t large = 100'000; ///< bytes, of allocations that may fail
constexpr std::int64_t elements = 50'000;

/// Collective. Runs the work with allocations failing on one rank; where they do, all must throw alike, and
/// then the communicator must be as good as before.
void expect_agreed_failure(const Communicator &comm, const std::function<void()> &work) {
  for (int unlucky = 0; unlucky < comm.size(); ++unlucky)
    for (std::int64_t which = 0;; ++which) {
      std::string text;
      bool struck = false;
      {
        std::optional<FailingAllocation> failing;
        if (comm.rank() == unlucky)
          failing.emplace(large, which);
        try {
          work();
        } catch (const Error &error) {
          text = error.what();
          EXPECT_EQ(error.kind(), ErrorKind::resource);
        }
        struck = failing && FailingAllocation::has_struck();
      }
      std::string text_of_root = text;
      broadcast(comm, text_of_root);
      EXPECT_EQ(text, text_of_root);
      EXPECT_TRUE(all_of_ranks(comm, text.empty()) || all_of_ranks(comm, !text.empty()));
      if (!any_of_ranks(comm, struck)) { // no more such allocations
        EXPECT_EQ(text, "");
        break;
      }
      EXPECT_NE(text.find("rank " + std::to_string(unlucky) + ": out of memory for 0.4 MiB"),
                std::string::npos)
          << text;
    }
}

Communicator world() { return Communicator::duplicate(boost::mpi::communicator()); }

TEST(Memory, ExchangeAgreesThatOneRankLacksIt) {
  const Communicator comm = world();
  const auto ranks = static_cast<std::size_t>(comm.size());
  const std::vector<std::int64_t> counts(ranks, elements / comm.size() + 1);
  const std::vector<std::int64_t> data(ranks * static_cast<std::size_t>(counts.front()));
  expect_agreed_failure(comm, [&] { exchange<std::int64_t>(comm, data, counts); });
}

TEST(Memory, GatherAndBroadcastAgreeThatOneRankLacksIt) {
  const Communicator comm = world();
  const std::vector<std::int64_t> part(static_cast<std::size_t>(elements / comm.size() + 1));
  expect_agreed_failure(comm, [&] { gather_bulk<std::int64_t>(comm, part, comm.size() - 1); });
  expect_agreed_failure(comm, [&] { all_gather_bulk<std::int64_t>(comm, part); });
  std::vector<std::int64_t> data;
  if (comm.is_root())
    data.resize(static_cast<std::size_t>(elements));
  expect_agreed_failure(comm, [&] {
    if (!comm.is_root())
      data = {};
    broadcast_bulk(comm, data, 0);
  });
}

TEST(Memory, SparseExchangeAgreesThatOneRankLacksIt) {
  const Communicator comm = world();
  const std::vector<std::int64_t> data(static_cast<std::size_t>(elements));
  for (const int distance : {0, 1}) {
    const std::vector<Outgoing<std::int64_t>> outgoing{{(comm.rank() + distance) % comm.size(), data}};
    expect_agreed_failure(comm, [&] {
      const auto incoming = sparse_exchange<std::int64_t>(comm, outgoing);
      EXPECT_EQ(incoming.size(), 1U);
      EXPECT_EQ(incoming.at(0).data.size(), data.size());
    });
  }
}

TEST(Memory, SparseExchangeListensToMoreThanItCanNote) {
  const Communicator comm = world();
  // So many small letters that noting them takes an allocation that fails.
  const std::vector<int> data(1, comm.rank());
  std::vector<Outgoing<int>> outgoing;
  for (int to = 0; to < comm.size(); ++to)
    outgoing.push_back({to, data});
  for (int unlucky = 0; unlucky < comm.size(); ++unlucky)
    for (std::int64_t which = 0; which < 6; ++which) {
      int failed = 0;
      {
        std::optional<FailingAllocation> failing;
        if (comm.rank() == unlucky)
          failing.emplace(sizeof(bulk::IncomingBytes), which);
        try {
          const auto incoming = sparse_exchange<int>(comm, outgoing);
          EXPECT_EQ(std::ssize(incoming), comm.size());
        } catch (const Error &) {
          failed = 1;
        }
      }
      EXPECT_EQ(failed, all_reduce_max(comm, failed));
    }
}

} // namespace
} // namespace dovetail::testing
