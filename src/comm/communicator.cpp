#include "dovetail/comm/communicator.hpp"

#include <utility>

namespace dovetail {
namespace {
constexpr std::int64_t default_chunk_bytes = std::int64_t{1} << 30;
}

Communicator::Communicator(boost::mpi::communicator handle, std::shared_ptr<Traffic> traffic,
                           std::int64_t chunk_bytes)
    : handle_(std::move(handle)), traffic_(std::move(traffic)), chunk_bytes_(chunk_bytes),
      rank_(handle_.rank()), size_(handle_.size()) {
  MPI_Comm_set_errhandler(raw(), MPI_ERRORS_ARE_FATAL);
}

Communicator Communicator::duplicate(const boost::mpi::communicator &parent) {
  return {boost::mpi::communicator(static_cast<MPI_Comm>(parent), boost::mpi::comm_duplicate),
          std::make_shared<Traffic>(), default_chunk_bytes};
}

Communicator Communicator::duplicate(MPI_Comm parent) {
  return {boost::mpi::communicator(parent, boost::mpi::comm_duplicate), std::make_shared<Traffic>(),
          default_chunk_bytes};
}

Communicator Communicator::split(int color) const { return {handle_.split(color), traffic_, chunk_bytes_}; }

Communicator Communicator::duplicate() const {
  return {boost::mpi::communicator(static_cast<MPI_Comm>(handle_), boost::mpi::comm_duplicate), traffic_,
          chunk_bytes_};
}

} // namespace dovetail
