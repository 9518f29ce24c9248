// Agrees on an error with itself, and prints it: a program with its own MPI over the installed library.
#include <dovetail/comm/agreement.hpp>

#include <boost/mpi/environment.hpp>

#include <cstdio>

int main(int argc, char **argv) {
  const boost::mpi::environment environment(argc, argv);
  const auto comm = dovetail::Communicator::duplicate(boost::mpi::communicator());
  try {
    dovetail::collectively(comm, [] {
      throw dovetail::Error({dovetail::ErrorKind::input, "points.f64", "", "it is not there", ""});
    });
  } catch (const dovetail::Error &error) {
    std::puts(error.what());
  }
}
