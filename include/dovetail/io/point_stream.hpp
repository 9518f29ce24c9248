/// Point files read piece by piece, for what does not fit into memory.
#pragma once

#include "dovetail/distributed/sort_on_disk.hpp"
#include "dovetail/io/points.hpp"

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace dovetail {

/// This rank's points of all files, as read_points shares and numbers them.
class PointFiles : public PointStream {
public:
  ~PointFiles() override = default;
  /// All that read_points says of the files; the points are not there, and the counts are those of all ranks
  /// once begin_again has been called.
  virtual PointInput &input() = 0;
  /// Local. How many points all files have: of text about, of LAS with those that will be skipped.
  virtual GlobalIndex estimated_points() const = 0;
  /// Local. Distinct points of at most so many records, taken from all over the files.
  virtual std::vector<Point> sample(std::size_t records) const = 0;
};

/// Collective. Reads the headers. Errors, here and in reading, as read_points.
std::unique_ptr<PointFiles> open_point_files(const Communicator &comm, std::span<const std::string> paths,
                                             const PointReading &reading = {});

} // namespace dovetail
