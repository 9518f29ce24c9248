#include "dovetail/comm/communicator.hpp"

#include <utility>

namespace dovetail {
namespace {
constexpr std::int64_t default_chunk_bytes = std::int64_t{1} << 30;
}

Communicator::Communicator(boost::mpi::communicator handle, std::shared_ptr<Traffic> traffic,
                           std::int64_t chunk_bytes, int top_rank)
    : handle_(std::move(handle)), traffic_(std::move(traffic)), chunk_bytes_(chunk_bytes),
      rank_(handle_.rank()), size_(handle_.size()), top_rank_(top_rank) {
  MPI_Comm_set_errhandler(raw(), MPI_ERRORS_ARE_FATAL);
}

Communicator Communicator::duplicate(const boost::mpi::communicator &parent) {
  return duplicate(static_cast<MPI_Comm>(parent));
}

Communicator Communicator::duplicate(MPI_Comm parent) {
  boost::mpi::communicator copy(parent, boost::mpi::comm_duplicate);
  const int rank = copy.rank();
  return {std::move(copy), std::make_shared<Traffic>(), default_chunk_bytes, rank};
}

Communicator Communicator::split(int color) const {
  return {handle_.split(color), traffic_, chunk_bytes_, top_rank_};
}

Communicator Communicator::duplicate() const {
  return {boost::mpi::communicator(static_cast<MPI_Comm>(handle_), boost::mpi::comm_duplicate), traffic_,
          chunk_bytes_, top_rank_};
}

} // namespace dovetail
