/// What triangulating will take, from the number of points and a sample of them. Local.
///
/// Paths are measured on the sample and on a quarter of it, which tells how they grow: as the square root
/// where sites fill the plane, in proportion where they lie on a circle or a cross, and there neither memory
/// nor slabs can be saved (section "Cost and limits" of include/dovetail/README.md).
#pragma once

#include "dovetail/base/types.hpp"
#include "dovetail/distributed/slabs.hpp"

#include <cstdint>
#include <vector>

namespace dovetail {

/// What is known beforehand.
struct Undertaking {
  GlobalIndex points = 0;
  int attributes = 0;
  int ranks = 1;
  int slabs = 0;                 ///< 0: to be chosen
  std::int64_t memory_bytes = 0; ///< that a rank may use, besides what every program needs
  AxisChoice axis = AxisChoice::automatic;
  bool on_disk = false;    ///< sites are to wait there even if they fit into memory
  bool keeps_mesh = false; ///< an output that needs the whole mesh in memory
};

struct Forecast {
  bool on_disk = false; ///< sites wait on disk
  Axis axis = Axis::x;
  int slabs = 1;
  GlobalIndex path_sites = 0;     ///< of one line, about
  std::int64_t memory_bytes = 0;  ///< of a rank: what it cannot do without
  std::int64_t scratch_bytes = 0; ///< of all ranks
  std::int64_t mesh_bytes = 0;    ///< of the .vtkhdf
  double seconds = 0;             ///< as on one 3 GHz core a rank and a disk of 500 MB/s: a rough idea
  bool fits = true;               ///< in memory
};

// Bytes, measured: a site of a slab, path included, with its columns (8 more for each attribute), the
// kernel's memory and its triangles (74, and a margin); and a site of a path until all is stitched, with own
// hulls, scans, open sides, twins and ghosts.
inline constexpr std::int64_t bytes_of_slab_site = 90;
inline constexpr std::int64_t bytes_of_path_site = 320;

/// So many sites of a slab, with what the kernel makes of them, take a quarter of this memory; at least 500.
GlobalIndex most_slab_sites(std::int64_t memory_bytes);

/// `sample`: distinct points in any order; may be empty, and paths are then taken to be those of uniform
/// sites. O(sample log sample).
Forecast forecast(const Undertaking &undertaking, std::vector<Point> sample);

} // namespace dovetail
