#include "point_readers.hpp"

#include "support/las_bytes.hpp"

using namespace dovetail;
using namespace dovetail::testing;

int LLVMFuzzerTestOneInput(const std::uint8_t *data, std::size_t size) {
  return fuzz::check_points(data, size, PointFormat::las);
}

std::vector<std::string> fuzz::seeds() {
  std::vector<std::string> seeds;
  for (int format = 0; format <= 10; ++format) {
    LasFile file;
    file.format = format;
    file.minor = format >= 6 ? 4 : format % 4;
    file.counts = format >= 6 ? LasCounts::only_64_bits : LasCounts::only_32_bits;
    for (int i = 0; i < 4; ++i)
      file.points.push_back({100 * i, -7 * i * i, 1 << (7 * i), i, i == 2});
    file.records.push_back(
        {"LASF_Projection", 34735, "keys", std::string("\1\0\1\0\0\0\1\0\0\14\0\0\1\0\x16\x7f", 16)});
    file.records.push_back({"somebody", 7, "else", "data"});
    if (file.minor == 4)
      file.extended_records.push_back({"LASF_Projection", 2112, "WKT", "PROJCS[\"nowhere\"]"});
    file.extra_bytes = static_cast<std::size_t>(format % 3);
    file.header_extra = static_cast<std::size_t>(format % 2);
    file.gap = static_cast<std::size_t>(format % 5);
    seeds.push_back(las_bytes(file));
  }
  LasFile old;
  old.minor = 0;
  old.uncounted_signature = true;
  old.points = {{1, 2, 3}, {4, 5, 6}};
  seeds.push_back(las_bytes(old));
  return seeds;
}
