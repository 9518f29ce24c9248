#include "dovetail/comm/collectives.hpp"
#include "dovetail/comm/exchange.hpp"

#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <numeric>

using namespace dovetail;

namespace {

constexpr std::array<std::int64_t, 4> chunk_sizes{1, 7, 64, std::int64_t{1} << 30};

Communicator world(std::int64_t chunk_bytes) {
  Communicator comm = Communicator::duplicate(boost::mpi::communicator());
  comm.set_chunk_bytes(chunk_bytes);
  return comm;
}

/// Twelve bytes: not a power of two, and larger than the smallest chunks.
struct Record {
  std::int32_t from;
  std::int32_t to;
  std::int32_t number;
  friend bool operator==(const Record &, const Record &) = default;
};
static_assert(sizeof(Record) == 12);

using Counts = std::int64_t (*)(int from, int to);
/// Who sends how many to whom.
constexpr std::array<Counts, 6> patterns{
    [](int, int) -> std::int64_t { return 0; },
    [](int from, int to) -> std::int64_t { return (from * 7 + to * 3) % 11; },
    [](int from, int to) -> std::int64_t { return from == to ? 40 : 0; },
    [](int from, int) -> std::int64_t { return from == 0 ? 33 : 0; }, // one rank has everything
    [](int, int to) -> std::int64_t { return to == 1 ? 29 : 0; },     // one rank gets everything
    [](int from, int to) -> std::int64_t { return to == from + 1 ? 100
                                                  : from == 2    ? 1
                                                                 : 0; }};

struct Parcel {
  std::vector<Record> data;
  std::vector<std::int64_t> counts;
};

Parcel sent_by(int from, int ranks, Counts pattern) {
  Parcel parcel;
  for (int to = 0; to < ranks; ++to) {
    parcel.counts.push_back(pattern(from, to));
    for (int i = 0; i < pattern(from, to); ++i)
      parcel.data.push_back({from, to, i});
  }
  return parcel;
}

Parcel received_by(int to, int ranks, Counts pattern) {
  Parcel parcel;
  for (int from = 0; from < ranks; ++from) {
    parcel.counts.push_back(pattern(from, to));
    for (int i = 0; i < pattern(from, to); ++i)
      parcel.data.push_back({from, to, i});
  }
  return parcel;
}

/// Messages of `count` elements of `bytes` each when no message may exceed `chunk`.
std::int64_t messages_for(std::int64_t count, std::int64_t bytes, std::int64_t chunk) {
  const std::int64_t each = std::max<std::int64_t>(1, chunk / bytes);
  return (count + each - 1) / each;
}

TEST(Exchange, DeliversEveryPatternAtEveryChunkSize) {
  for (const std::int64_t chunk : chunk_sizes) {
    const Communicator comm = world(chunk);
    for (const Counts pattern : patterns) {
      const Parcel mine = sent_by(comm.rank(), comm.size(), pattern);
      const Parcel expected = received_by(comm.rank(), comm.size(), pattern);
      const Traffic before = comm.traffic();
      const Exchanged<Record> got = exchange<Record>(comm, mine.data, mine.counts);
      EXPECT_EQ(got.counts, expected.counts);
      EXPECT_EQ(got.data, expected.data);
      // The counts, and the agreement that there is room for what comes: an all-reduce of an int.
      const int agreement = static_cast<int>(std::bit_width(static_cast<unsigned>(comm.size() - 1)));
      std::int64_t bytes = 8 * (comm.size() - 1) + 4 * agreement;
      std::int64_t messages = comm.size() - 1 + agreement;
      for (int to = 0; to < comm.size(); ++to)
        if (to != comm.rank()) {
          bytes += 12 * pattern(comm.rank(), to);
          messages += messages_for(pattern(comm.rank(), to), 12, chunk);
        }
      EXPECT_EQ(comm.traffic().bytes_sent - before.bytes_sent, bytes);
      EXPECT_EQ(comm.traffic().messages_sent - before.messages_sent, messages);
    }
  }
}

TEST(Exchange, ColumnsFollowOneAnotherThroughOneBuffer) {
  const Communicator comm = world(7);
  const Parcel mine = sent_by(comm.rank(), comm.size(), patterns[1]);
  const Parcel expected = received_by(comm.rank(), comm.size(), patterns[1]);
  const auto counts = exchange_counts(comm, mine.counts);
  EXPECT_EQ(counts, expected.counts);
  std::vector<double> column(mine.data.size());
  std::vector<double> received(expected.data.size());
  for (const double factor : {1.0, 0.5}) {
    for (std::size_t i = 0; i < column.size(); ++i)
      column[i] = factor * mine.data[i].number + mine.data[i].from;
    exchange_into<double>(comm, column, mine.counts, received, counts);
    for (std::size_t i = 0; i < received.size(); ++i)
      EXPECT_EQ(received[i], factor * expected.data[i].number + expected.data[i].from);
  }
}

TEST(Exchange, SparseDeliversEveryPatternSortedByRank) {
  for (const std::int64_t chunk : chunk_sizes) {
    const Communicator comm = world(chunk);
    // Over and over without anything between, so that ranks run ahead of one another.
    for (int round = 0; round < 5; ++round)
      for (const Counts pattern : patterns) {
        std::vector<std::vector<Record>> data;
        for (int to = 0; to < comm.size(); ++to) {
          data.emplace_back();
          for (int i = 0; i < pattern(comm.rank(), to); ++i)
            data.back().push_back({comm.rank(), to, i + round});
        }
        std::vector<Outgoing<Record>> outgoing;
        for (int to = comm.size() - 1; to >= 0; --to)
          outgoing.push_back({to, data[static_cast<std::size_t>(to)]});
        const auto incoming = sparse_exchange<Record>(comm, outgoing);
        std::size_t at = 0;
        for (int from = 0; from < comm.size(); ++from) {
          const std::int64_t count = pattern(from, comm.rank());
          if (count == 0)
            continue;
          EXPECT_LT(at, incoming.size());
          if (at >= incoming.size())
            break;
          EXPECT_EQ(incoming[at].rank, from);
          EXPECT_EQ(std::ssize(incoming[at].data), count);
          for (std::size_t i = 0; i < incoming[at].data.size(); ++i)
            EXPECT_EQ(incoming[at].data[i], (Record{from, comm.rank(), static_cast<int>(i) + round}));
          ++at;
        }
        EXPECT_EQ(at, incoming.size());
      }
  }
}

TEST(Exchange, SparseWorksOnSplitCommunicatorsAtTheSameTime) {
  const Communicator comm = world(64);
  const Communicator part = comm.split(comm.rank() % 2);
  for (int round = 0; round < 10; ++round) {
    const int next = (part.rank() + 1) % part.size();
    const std::vector<int> data(static_cast<std::size_t>(comm.rank() + 1), comm.rank());
    const std::vector<Outgoing<int>> outgoing{{next, data}};
    const auto incoming = sparse_exchange<int>(part, outgoing);
    EXPECT_EQ(incoming.size(), 1u);
    if (incoming.size() != 1)
      return;
    const int from = (part.rank() + part.size() - 1) % part.size();
    const int from_top = 2 * from + comm.rank() % 2;
    EXPECT_EQ(incoming[0].rank, from);
    EXPECT_EQ(incoming[0].data, std::vector<int>(static_cast<std::size_t>(from_top + 1), from_top));
  }
}

TEST(Exchange, BulkGatherAndBroadcast) {
  for (const std::int64_t chunk : chunk_sizes) {
    const Communicator comm = world(chunk);
    for (int root = 0; root < comm.size(); ++root) {
      // Rank r has r * r elements but the root none.
      const auto count_of = [&](int r) { return r == root ? 0 : static_cast<std::size_t>(r * r); };
      const std::vector<std::int16_t> mine(count_of(comm.rank()), static_cast<std::int16_t>(comm.rank()));
      std::vector<std::int16_t> expected;
      std::vector<std::int64_t> expected_counts;
      for (int r = 0; r < comm.size(); ++r) {
        expected.insert(expected.end(), count_of(r), static_cast<std::int16_t>(r));
        expected_counts.push_back(static_cast<std::int64_t>(count_of(r)));
      }
      const auto gathered = gather_bulk<std::int16_t>(comm, mine, root);
      const bool is_root = comm.rank() == root;
      EXPECT_EQ(gathered.data, is_root ? expected : std::vector<std::int16_t>{});
      EXPECT_EQ(gathered.counts, is_root ? expected_counts : std::vector<std::int64_t>{});
      const auto everywhere = all_gather_bulk<std::int16_t>(comm, mine);
      EXPECT_EQ(everywhere.data, expected);
      EXPECT_EQ(everywhere.counts, expected_counts);
      std::vector<std::int16_t> spread(static_cast<std::size_t>(10 * comm.rank()),
                                       static_cast<std::int16_t>(comm.rank()));
      broadcast_bulk(comm, spread, root);
      EXPECT_EQ(spread, std::vector<std::int16_t>(static_cast<std::size_t>(10 * root),
                                                  static_cast<std::int16_t>(root)));
    }
  }
}

} // namespace
