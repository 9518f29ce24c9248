/// The partition-independent checksum of a mesh: a function of coordinates only (design of the hash:
/// include/dovetail/README.md). Local; the checksum of a whole is the sum of the checksums of its parts.
#pragma once

#include "dovetail/base/types.hpp"

#include <cstdint>
#include <span>
#include <string>

namespace dovetail {

std::uint64_t checksum_of_sites(std::span<const Point> sites);
/// corners: three vertex numbers a triangle, in any orientation.
std::uint64_t checksum_of_triangles(std::span<const Point> vertices, std::span<const LocalIndex> corners);
/// Sixteen hexadecimal digits.
std::string checksum_text(std::uint64_t checksum);

/// Order-independent hash of the input: what tells whether a mesh still belongs to its points.
std::uint64_t digest_of_point(Point point, double z, GlobalIndex input_index);

} // namespace dovetail
