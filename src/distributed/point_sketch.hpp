/// A sample of any number of points that is a function of their set. Local.
#pragma once

#include "dovetail/base/types.hpp"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace dovetail {

/// The distinct points with the smallest hashes of their coordinates: so neither the order in which they
/// come, nor how often, nor in which pieces, has an influence; and two sketches make that of the union.
/// Hashes do not resonate with rows and columns. (Bottom-k sampling: Cohen and Kaplan, Summarizing data using
/// bottom-k sketches, 2007.)
class PointSketch {
public:
  /// Of at most so many points.
  explicit PointSketch(std::size_t size) : size_(size) {}

  /// O(1) a point, most of it the hash.
  void add(std::span<const Point> points);
  /// By ascending hash.
  std::vector<Point> points();
  std::size_t size() const { return size_; }
  /// Those of its points that have a hash up to `limit`: how many, and as a sketch.
  std::int64_t count_up_to(std::uint64_t limit);
  PointSketch up_to(std::uint64_t limit);

private:
  struct Entry {
    std::uint64_t hash;
    Point point;
  };
  /// Those with a hash up to `limit`.
  void collect(std::span<const Point> points, std::uint64_t limit);
  void shrink();

  std::size_t size_;
  std::uint64_t limit_ = ~std::uint64_t{0}; ///< nothing of a larger hash can be in the sketch
  std::vector<Entry> entries_;              ///< those of the sketch among them
  bool is_shrunk_ = true;                   ///< no others
};

} // namespace dovetail
