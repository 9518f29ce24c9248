#include "point_readers.hpp"

using namespace dovetail;

int LLVMFuzzerTestOneInput(const std::uint8_t *data, std::size_t size) {
  return fuzz::check_points(data, size, PointFormat::node);
}

std::vector<std::string> fuzz::seeds() {
  return {
      "3 2 0 0\n0 0 0\n1 1 0\n2 0 1\n",
      "# Triangle\n2 2 2 1\n1 0.5 0.25 7 8 1\n2 1.5 -0.25 nan 1e3 0\n",
      "2 2\n1 0 0\n2 1 1",
      "0 2 0 0\n",
      "4 2 1 0\r\n0 0 0 1\r\n\r\n1 0 1 2 # here\r\n2 1 0 3\r\n3 1 1 4\r\n",
      "2 3 0 0\n0 0 0 0\n1 1 1 1\n",
      "9007199254740992 2 300 1\n0 0 0\n",
  };
}
