// A program that uses the kernel and nothing else. It must link and run where there is no MPI.
#include "dovetail/mesh/checksum.hpp"

#include <array>
#include <cstdio>

int main() {
  const std::array<dovetail::Point, 3> sites{{{0, 0}, {1, 0}, {0, 1}}};
  std::puts(dovetail::checksum_text(dovetail::checksum_of_sites(sites)).c_str());
}
