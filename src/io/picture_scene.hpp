/// What both kinds of pictures draw. Private to io.
#pragma once

#include "picture_layout.hpp"

#include "dovetail/comm/communicator.hpp"
#include "dovetail/io/picture.hpp"

#include <array>
#include <string>
#include <vector>

namespace dovetail::picture {

/// The same on all ranks but for the paths, which are those of the rank's slabs.
struct Scene {
  const DistributedMesh &mesh;
  const PictureOptions &options;
  Layout layout;
  Scale scale;
  double exaggeration = 1; ///< of heights, for their shading
  std::vector<std::vector<Point>> paths;
};

/// A triangle in pixels.
struct DrawnTriangle {
  std::array<Point, 3> corners;
  Colour colour;
  double edge_half_width; ///< 0 where there is no room for edges
};

/// Local. Corners first, since most of what is outside needs no colour.
std::array<Point, 3> corners_in_pixels(const Scene &scene, const SlabMesh &slab, LocalIndex triangle);
DrawnTriangle drawn_triangle(const Scene &scene, const SlabMesh &slab, LocalIndex triangle,
                             const std::array<Point, 3> &corners);

/// Local. Calls draw(from, to) with every hull edge of the slab, in pixels.
template <class Draw> void for_each_hull_edge(const Scene &scene, const SlabMesh &slab, Draw &&draw) {
  auto border = slab.border_sides.begin();
  for (std::size_t side = 0; side < slab.triangles.neighbours.size(); ++side) {
    if (slab.triangles.neighbours[side] != none)
      continue;
    if (border != slab.border_sides.end() && static_cast<std::size_t>(border->side) == side) {
      ++border;
      continue;
    }
    const std::size_t base = side - side % 3;
    const auto point = [&](std::size_t corner) {
      return scene.layout.view.to_pixels(
          slab.vertices.points[static_cast<std::size_t>(slab.triangles.corners[base + corner % 3])]);
    };
    draw(point(side + 1 - base), point(side + 2 - base));
  }
}

/// The slab that triangles of mesh.slabs[k] belong to is mesh.first_slab + k.
Colour edge_colour(Colouring colouring);
int edge_weight(Colouring colouring);
/// Half the widths of overlays, in pixels.
double hull_half_width(const Layout &layout);
double path_half_width(const Layout &layout);
double casing_half_width(const Layout &layout);

// Collective; errors as OutputFile.
void write_png(const Communicator &comm, const Scene &scene, const std::string &path);
void write_svg(const Communicator &comm, const Scene &scene, const std::string &path);

} // namespace dovetail::picture
