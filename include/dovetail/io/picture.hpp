/// Pictures of meshes of any size: `.png`, rasterised by all ranks, and `.svg` for small ones.
///
/// The bytes of a picture are a function of the mesh and the options alone, the same for every number of
/// ranks.
#pragma once

#include "dovetail/base/progress.hpp"
#include "dovetail/comm/communicator.hpp"
#include "dovetail/distributed/mesh.hpp"

#include <cstdint>
#include <optional>
#include <string>

namespace dovetail {

/// What the colour of a triangle means.
enum class Colouring : std::uint8_t {
  slab,      ///< which slab owns it
  angle,     ///< its smallest angle
  area,      ///< its area, on a logarithmic scale
  elevation, ///< its mean z, shaded as if lit from the north-west
};

struct Window {
  double x0, y0, x1, y1;
};

inline constexpr int least_picture_width = 16;
inline constexpr int most_picture_width = 20000;

struct PictureOptions {
  Colouring colouring = Colouring::slab;
  bool paths = false;           ///< draw the split paths
  bool hull = false;            ///< draw the convex hull
  std::optional<Window> window; ///< what is shown; else the box of all sites
  int width = 1600;             ///< in pixels; the height follows
  /// Pixels are drawn in bands of about this size on every rank.
  std::int64_t band_bytes = std::int64_t{64} << 20;
  Progress progress; ///< hears of the stage "draw"
};

/// Collective. Draws `mesh` into the file `path`, whose extension names the format; written aside and renamed
/// (io/output_file.hpp). Triangles are filled, their sides drawn where there is room, overlays above them, a
/// title and a legend around them (unless the picture is narrower than 280 pixels). Colours are told apart
/// also without red, green or blue receptors. A band of pixels is drawn at a time: all ranks draw what their
/// triangles cover, each adds up a part of the rows, and the root compresses them. Cost: one pass over the
/// triangles for every band, and one or two to find the range of the colours. Errors (usage): another
/// extension, a width out of range, a window that is empty or beside all sites, no z to colour by, an SVG of
/// more than 100,000 triangles. (output): as OutputFile.
void write_picture(const Communicator &comm, const DistributedMesh &mesh, const std::string &path,
                   const PictureOptions &options = {});

} // namespace dovetail
