#include "dovetail/mesh/checksum.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <fmt/core.h>

namespace dovetail {
namespace {

// What a word sequence begins with: so a site and a triangle of the same words differ.
constexpr std::uint64_t triangle_start = 1;
constexpr std::uint64_t site_start = 2;
constexpr std::uint64_t input_point_start = 3;

/// The finaliser of splitmix64.
constexpr std::uint64_t mix(std::uint64_t v) {
  v = (v ^ (v >> 30)) * 0xbf58476d1ce4e5b9U;
  v = (v ^ (v >> 27)) * 0x94d049bb133111ebU;
  return v ^ (v >> 31);
}

constexpr std::uint64_t append(std::uint64_t hash, std::uint64_t word) {
  return mix((hash ^ word) + 0x9e3779b97f4a7c15U);
}

// Adding zero turns -0.0 into 0.0, which is the same site.
std::uint64_t append(std::uint64_t hash, double value) {
  return append(hash, std::bit_cast<std::uint64_t>(value + 0.0));
}

std::uint64_t append(std::uint64_t hash, Point p) { return append(append(hash, p.x), p.y); }

} // namespace

std::uint64_t checksum_of_sites(std::span<const Point> sites) {
  std::uint64_t sum = 0;
  for (const Point &site : sites)
    sum += append(site_start, site);
  return sum;
}

std::uint64_t checksum_of_triangles(std::span<const Point> vertices, std::span<const LocalIndex> corners) {
  std::uint64_t sum = 0;
  for (std::size_t t = 0; t + 2 < corners.size(); t += 3) {
    std::array<Point, 3> triangle;
    for (std::size_t i = 0; i < 3; ++i)
      triangle[i] = vertices[static_cast<std::size_t>(corners[t + i])];
    std::ranges::sort(triangle, lexicographically_less);
    std::uint64_t hash = triangle_start;
    for (const Point &corner : triangle)
      hash = append(hash, corner);
    sum += hash;
  }
  return sum;
}

std::string checksum_text(std::uint64_t checksum) { return fmt::format("{:016x}", checksum); }

std::uint64_t digest_of_point(Point point, double z, GlobalIndex input_index) {
  return append(append(append(input_point_start, point), z), static_cast<std::uint64_t>(input_index));
}

} // namespace dovetail
