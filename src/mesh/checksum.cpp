#include "dovetail/mesh/checksum.hpp"

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

/// Which of three corners comes first, second and third lexicographically. Their order is as good as random:
/// a branch on it would be mispredicted half the time, and keep the processor from working on several
/// triangles at once. So it is found by arithmetic.
struct Ascending {
  std::size_t first, second, third;
};

Ascending ascending(std::span<const Point> vertices, std::size_t a, std::size_t b, std::size_t c) {
  const auto less = [](Point p, Point q) {
    return static_cast<std::size_t>(p.x < q.x) |
           (static_cast<std::size_t>(p.x == q.x) & static_cast<std::size_t>(p.y < q.y));
  };
  const auto pick = [](std::size_t which, std::size_t if_one, std::size_t if_zero) {
    return if_zero ^ ((if_one ^ if_zero) & (0 - which));
  };
  const Point p = vertices[a], q = vertices[b], r = vertices[c];
  const std::size_t ab = less(p, q), ac = less(p, r), bc = less(q, r);
  const std::size_t first = pick(ab, pick(ac, a, c), pick(bc, b, c));
  const std::size_t third = pick(ab, pick(bc, c, b), pick(ac, c, a));
  return {first, a ^ b ^ c ^ first ^ third, third};
}

} // namespace

std::uint64_t checksum_of_sites(std::span<const Point> sites) {
  std::uint64_t sum = 0;
  for (const Point &site : sites)
    sum += append(site_start, site);
  return sum;
}

std::uint64_t checksum_of_triangles(std::span<const Point> vertices, std::span<const LocalIndex> corners) {
  // Triangles that lie near each other have vertices that do not: without a word ahead of time, every other
  // triangle would wait for memory.
  constexpr std::size_t ahead = 3 * 32;
  std::uint64_t sum = 0;
  for (std::size_t t = 0; t + 2 < corners.size(); t += 3) {
    const auto corner = [&](std::size_t i) { return static_cast<std::size_t>(corners[t + i]); };
    if (t + ahead + 2 < corners.size())
      for (std::size_t i = 0; i < 3; ++i)
        __builtin_prefetch(&vertices[corner(ahead + i)]);
    const Ascending order = ascending(vertices, corner(0), corner(1), corner(2));
    std::uint64_t hash = append(triangle_start, vertices[order.first]);
    hash = append(append(hash, vertices[order.second]), vertices[order.third]);
    sum += hash;
  }
  return sum;
}

std::string checksum_text(std::uint64_t checksum) { return fmt::format("{:016x}", checksum); }

std::uint64_t digest_of_point(Point point, double z, GlobalIndex input_index) {
  return append(append(append(input_point_start, point), z), static_cast<std::uint64_t>(input_index));
}

} // namespace dovetail
