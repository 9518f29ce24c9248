/// A group of ranks, owned. Wraps boost::mpi::communicator, which is copyable, in a handle that is not.
#pragma once

#include <boost/mpi/communicator.hpp>

#include <cstdint>
#include <memory>

namespace dovetail {

/// What this rank has handed to MPI, over a communicator and all that were split from it.
struct Traffic {
  std::int64_t bytes_sent = 0;
  std::int64_t messages_sent = 0;
};

/// Move-only. Every collective that makes one has a visible name. A failure of MPI itself is fatal on it,
/// whatever the caller's own communicator does.
class Communicator {
public:
  /// Collective over `parent`: a private copy, so that our messages never meet the caller's.
  static Communicator duplicate(const boost::mpi::communicator &parent);
  static Communicator duplicate(MPI_Comm parent);

  Communicator(Communicator &&) noexcept = default;
  Communicator &operator=(Communicator &&) noexcept = default;
  Communicator(const Communicator &) = delete;
  Communicator &operator=(const Communicator &) = delete;
  ~Communicator() = default;

  int rank() const { return rank_; }
  int size() const { return size_; }
  bool is_root() const { return rank_ == 0; }
  /// Rank on the first communicator that this one was made from: the number by which people know it.
  int top_rank() const { return top_rank_; }

  /// Collective: the ranks that gave the same color, in the order of their ranks. Shares the traffic count.
  Communicator split(int color) const;
  /// Collective.
  Communicator duplicate() const;

  /// Bulk messages are cut so that no single one is larger than this many bytes (at least one element).
  std::int64_t chunk_bytes() const { return chunk_bytes_; }
  void set_chunk_bytes(std::int64_t bytes) { chunk_bytes_ = bytes; }

  /// For sparse_exchange: counts its calls on this handle, alike on all ranks.
  int next_sparse_round() const { return sparse_round_++; }

  Traffic &traffic() const { return *traffic_; }
  const boost::mpi::communicator &boost() const { return handle_; }
  MPI_Comm raw() const { return static_cast<MPI_Comm>(handle_); }

private:
  Communicator(boost::mpi::communicator handle, std::shared_ptr<Traffic> traffic, std::int64_t chunk_bytes,
               int top_rank);

  boost::mpi::communicator handle_;
  std::shared_ptr<Traffic> traffic_;
  std::int64_t chunk_bytes_;
  int rank_;
  int size_;
  int top_rank_;
  mutable int sparse_round_ = 0;
};

} // namespace dovetail
