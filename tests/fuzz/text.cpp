#include "point_readers.hpp"

using namespace dovetail;

int LLVMFuzzerTestOneInput(const std::uint8_t *data, std::size_t size) {
  return fuzz::check_points(data, size, PointFormat::text);
}

std::vector<std::string> fuzz::seeds() {
  return {
      "",
      "0 0\n1 0\n0 1\n",
      "# a comment\nx,y,z\n1.5,2.5e3,-3\n4,5,6.25\n",
      "\xef\xbb\xbfX;\"the Y\";Z;y\r\n1;2;3;4\r\n\r\n5;;7;nan\r\n",
      "1\t2\t3\n\n  4 5 6 // far\n+7 -8 9e-300",
      "1 2\n3,4\n",
      "1,5 2,5\n",
      "id,Northing,x,y,y,\n1,2,3,4,5,\n",
      "1 2 3\n4 5\n",
      "inf 0\n",
      "0 1e999\n0 1e-999\n",
      "0.1000000000000000055511151231257827021181583404541015625 9007199254740993\n",
      "a b\n",
      "x y\n",
  };
}
