// The oracle of all readers of points: what must hold whatever a file holds.
#pragma once

#include "target.hpp"

#include "dovetail/io/points.hpp"

namespace dovetail::fuzz {

// Reads the bytes as a file of this format. Either an Error says what is wrong, or
// - coordinates are finite, no zero is negative, columns are equally long, and records are numbered in order;
// - three ranks with the smallest buffers read the same points, or fail with the same words;
// - written as .csv, .node and .npy and read again, the points have the same bits.
void check_points(std::span<const std::byte> bytes, PointFormat format);

// `check_points` as a target.
int check_points(const std::uint8_t *data, std::size_t size, PointFormat format);

} // namespace dovetail::fuzz
