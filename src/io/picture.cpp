#include "dovetail/io/picture.hpp"

#include "picture_scene.hpp"

#include "dovetail/comm/agreement.hpp"
#include "dovetail/comm/collectives.hpp"
#include "dovetail/distributed/path_points.hpp"
#include "dovetail/mesh/histogram.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <numeric>

namespace dovetail {
namespace picture {
namespace {

template <class T> std::size_t at(T index) { return static_cast<std::size_t>(index); }

constexpr GlobalIndex most_svg_triangles = 100'000;
/// So much of what is seen may lie outside the colours' range at either end: a little would use up all
/// colours.
constexpr double beyond_scale = 0.02;
constexpr double median_shaded_slope = 0.35;

[[noreturn]] void refuse(const std::string &subject, std::string what, std::string remedy) {
  throw Error({ErrorKind::usage, subject, "", std::move(what), std::move(remedy)});
}

const std::vector<double> *z_of(const SlabMesh &slab) {
  for (const Attribute &attribute : slab.vertices.attributes)
    if (attribute.name == "z")
      return &attribute.values;
  return nullptr;
}

/// A triangle's corners with their heights, or 0.
struct Corners {
  std::array<Point, 3> points;
  std::array<double, 3> z;
  double doubled_area() const {
    const auto &[a, b, c] = points;
    return std::abs((b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x));
  }
};
Corners corners_of(const SlabMesh &slab, LocalIndex triangle) {
  Corners corners{};
  const std::vector<double> *z = z_of(slab);
  for (std::size_t i = 0; i < 3; ++i) {
    const auto v = at(slab.triangles.corners[3 * at(triangle) + i]);
    corners.points[i] = slab.vertices.points[v];
    corners.z[i] = z != nullptr ? (*z)[v] : 0;
  }
  return corners;
}

double smallest_angle(const Corners &corners) {
  double smallest = 180;
  for (std::size_t i = 0; i < 3; ++i) {
    const Point p = corners.points[i];
    const Point q = corners.points[(i + 1) % 3];
    const Point r = corners.points[(i + 2) % 3];
    const double dot = (q.x - p.x) * (r.x - p.x) + (q.y - p.y) * (r.y - p.y);
    smallest = std::min(smallest, std::atan2(corners.doubled_area(), dot) * 57.29577951308232);
  }
  return smallest;
}

double mean_z(const Corners &corners) { return (corners.z[0] + corners.z[1] + corners.z[2]) / 3; }

/// How z changes with x and with y on the plane of the triangle.
Point gradient(const Corners &corners) {
  const auto &[a, b, c] = corners.points;
  const Point u{b.x - a.x, b.y - a.y};
  const Point v{c.x - a.x, c.y - a.y};
  const double uz = corners.z[1] - corners.z[0];
  const double vz = corners.z[2] - corners.z[0];
  const double whole = u.x * v.y - u.y * v.x;
  return {(uz * v.y - vz * u.y) / whole, (vz * u.x - uz * v.x) / whole};
}

/// How bright a plane is when lit from the north-west, half-way up; 1 if it is level.
double brightness(Point slope, double exaggeration) {
  const double dx = slope.x * exaggeration;
  const double dy = slope.y * exaggeration;
  const double facing = (dx - dy + std::sqrt(2.0)) / (2 * std::sqrt(1 + dx * dx + dy * dy));
  const double light = std::max(0.0, facing) * std::sqrt(2.0);
  return std::isfinite(light) ? 0.35 + 0.65 * light : 1;
}

Colour shaded(Colour colour, double light) {
  const auto channel = [&](std::uint8_t value) {
    return static_cast<std::uint8_t>(std::lround(std::min(255.0, value * light)));
  };
  return {channel(colour.red), channel(colour.green), channel(colour.blue)};
}

/// With the corners of every triangle whose box meets the window.
template <class Use> void for_each_triangle(const DistributedMesh &mesh, const Window &window, Use &&use) {
  for (const SlabMesh &slab : mesh.slabs)
    for (LocalIndex t = 0; t < slab.triangles.triangle_count(); ++t) {
      const Corners corners = corners_of(slab, t);
      const auto &[a, b, c] = corners.points;
      if (std::max({a.x, b.x, c.x}) >= window.x0 && std::min({a.x, b.x, c.x}) <= window.x1 &&
          std::max({a.y, b.y, c.y}) >= window.y0 && std::min({a.y, b.y, c.y}) <= window.y1)
        use(corners);
    }
}

/// The area of the part of a triangle, or any convex polygon, that is in the unit square, doubled.
double doubled_area_in_unit_square(std::vector<Point> outline) {
  // Clipped by one side of the square after the other (Sutherland and Hodgman, CACM 17, 1974): by x >= 0, and
  // then turned by a quarter.
  for (int side = 0; side < 4; ++side) {
    std::vector<Point> kept;
    for (std::size_t i = 0; i < outline.size(); ++i) {
      const Point p = outline[i];
      const Point q = outline[(i + 1) % outline.size()];
      if (p.x >= 0)
        kept.push_back({1 - p.y, p.x});
      if ((p.x >= 0) != (q.x >= 0))
        kept.push_back({1 - (p.y + (q.y - p.y) * (p.x / (p.x - q.x))), 0});
    }
    outline = std::move(kept);
  }
  double area = 0;
  for (std::size_t i = 1; i + 1 < outline.size(); ++i)
    area += (outline[i].x - outline[0].x) * (outline[i + 1].y - outline[0].y) -
            (outline[i].y - outline[0].y) * (outline[i + 1].x - outline[0].x);
  return area;
}

/// How much of the window a triangle covers: a whole number, so that sums do not depend on their order.
GlobalIndex share_of_window(const Corners &corners, const Window &window) {
  constexpr double whole = 0x1p40;
  Corners scaled = corners;
  bool inside = true;
  for (Point &p : scaled.points) {
    p = {(p.x - window.x0) / (window.x1 - window.x0), (p.y - window.y0) / (window.y1 - window.y0)};
    inside = inside && p.x >= 0 && p.x <= 1 && p.y >= 0 && p.y <= 1;
  }
  const double doubled = inside ? scaled.doubled_area()
                                : doubled_area_in_unit_square({scaled.points.begin(), scaled.points.end()});
  return doubled >= 0 && doubled <= 2 ? static_cast<GlobalIndex>(doubled / 2 * whole) : 0; // NaN, too
}

/// What is seen has values from `low` to `high`, and nearly all of it those of `scale`.
struct SeenValues {
  Scale scale;
  double low, high; ///< low > high: none
};

/// Collective: the values that `value_of` gives to what is seen. Only finite values count.
template <class ValueOf>
SeenValues seen_values(const Communicator &comm, const DistributedMesh &mesh, const Window &window,
                       bool logarithmic, ValueOf &&value_of) {
  constexpr std::size_t bins = 4096;
  constexpr double infinity = std::numeric_limits<double>::infinity();
  const auto place_of = [&](const Corners &corners) {
    return logarithmic ? std::log(value_of(corners)) : value_of(corners);
  };
  std::vector<double> ends{infinity, infinity};
  for_each_triangle(mesh, window, [&](const Corners &corners) {
    if (const double place = place_of(corners); std::isfinite(place))
      ends = {std::min(ends[0], place), std::min(ends[1], -place)};
  });
  ends = all_reduce_min(comm, ends);
  const double low = ends[0];
  const double high = -ends[1];
  const auto value_at = [&](double place) { return logarithmic ? std::exp(place) : place; };
  SeenValues seen{{0, 1, false}, value_at(low), value_at(high)};
  if (low == high)
    seen.scale = logarithmic ? Scale{seen.low / 2, seen.low * 2, true} : Scale{low - 0.5, low + 0.5, false};
  if (!(low < high))
    return seen;
  std::vector<GlobalIndex> shares(bins, 0);
  for_each_triangle(mesh, window, [&](const Corners &corners) {
    if (const double place = place_of(corners); std::isfinite(place))
      shares[std::min(bins - 1, static_cast<std::size_t>((place - low) / (high - low) * bins))] +=
          share_of_window(corners, window);
  });
  shares = all_reduce_sum(comm, shares);
  const auto tail = static_cast<GlobalIndex>(
      beyond_scale * static_cast<double>(std::accumulate(shares.begin(), shares.end(), GlobalIndex{0})));
  std::size_t first = 0;
  for (GlobalIndex below = 0; first + 1 < bins && below + shares[first] <= tail; ++first)
    below += shares[first];
  std::size_t end = bins;
  for (GlobalIndex above = 0; end > first + 1 && above + shares[end - 1] <= tail; --end)
    above += shares[end - 1];
  const auto bound = [&](std::size_t bin) {
    return value_at(low + (high - low) * (static_cast<double>(bin) / bins));
  };
  seen.scale = {bound(first), bound(end), logarithmic};
  return seen;
}

/// Collective. Heights are seldom in the units that make a relief readable: steeper than
/// `median_shaded_slope` shall be about half of the triangles.
double exaggeration_of(const Communicator &comm, const DistributedMesh &mesh, const Window &window) {
  Histogram slopes(bounds_of_magnitudes());
  for_each_triangle(mesh, window, [&](const Corners &corners) {
    const Point slope = gradient(corners);
    if (const double steepness = std::hypot(slope.x, slope.y); std::isfinite(steepness) && steepness > 0)
      slopes.add(steepness);
  });
  slopes.counts = all_reduce_sum(comm, slopes.counts);
  const GlobalIndex half = slopes.total() / 2;
  GlobalIndex below = 0;
  for (std::size_t bin = 0; bin < slopes.counts.size(); ++bin) {
    below += slopes.counts[bin];
    if (below > half)
      return median_shaded_slope / slopes.bounds[bin + 1];
  }
  return 1;
}

/// Collective: the box of all sites. Nothing if there are none.
std::optional<Window> box_of(const Communicator &comm, const DistributedMesh &mesh) {
  std::vector<double> low(4, std::numeric_limits<double>::infinity());
  for (const SlabMesh &slab : mesh.slabs)
    for (const Point p : slab.vertices.points)
      low = {std::min(low[0], p.x), std::min(low[1], p.y), std::min(low[2], -p.x), std::min(low[3], -p.y)};
  low = all_reduce_min(comm, low);
  if (mesh.site_count() == 0)
    return {};
  return Window{low[0], low[1], -low[2], -low[3]};
}

/// Throws what is wrong with a request, alike on all ranks.
Window window_of(const Window &box, const PictureOptions &options) {
  if (!options.window) {
    const double across = (box.x1 - box.x0) / 100;
    const double up = (box.y1 - box.y0) / 100;
    return {box.x0 - across, box.y0 - up, box.x1 + across, box.y1 + up};
  }
  const Window w = *options.window;
  const std::string subject = fmt::format("the window {},{},{},{}", w.x0, w.y0, w.x1, w.y1);
  if (!(w.x0 < w.x1) || !(w.y0 < w.y1) || !std::isfinite(w.x1 - w.x0) || !std::isfinite(w.y1 - w.y0))
    refuse(subject, "is empty", "give its lower left and its upper right corner: x0,y0,x1,y1");
  if (w.x1 < box.x0 || w.x0 > box.x1 || w.y1 < box.y0 || w.y0 > box.y1)
    refuse(subject, "is beside the mesh",
           fmt::format("choose one within x {} to {}, y {} to {}", box.x0, box.x1, box.y0, box.y1));
  return w;
}

void check_options(const DistributedMesh &mesh, const std::string &path, bool svg, bool has_z,
                   const PictureOptions &options) {
  if (options.width < least_picture_width || options.width > most_picture_width)
    refuse(path, fmt::format("a picture cannot be {} pixels wide", options.width),
           fmt::format("choose from {} to {}", least_picture_width, most_picture_width));
  if (options.colouring == Colouring::elevation && !has_z)
    refuse(path, "elevation is asked for, and the mesh has no z",
           "triangulate points with a column named z, or with three columns and no names; or colour by slab, "
           "angle or area");
  if (svg && mesh.triangle_count() > most_svg_triangles)
    refuse(path, fmt::format("{} triangles are too many for an SVG", mesh.triangle_count()),
           fmt::format("let the name end in .png, which has no limit (of an SVG: {})", most_svg_triangles));
}

/// "x 0 to 12.5, y -3 to 7".
std::string part_text(const Window &part) {
  const auto range = [](double low, double high) {
    const double step = (high - low) / 1000;
    return number_text(low, step) + " to " + number_text(high, step);
  };
  return "x " + range(part.x0, part.x1) + ", y " + range(part.y0, part.y1);
}

/// What the scale's colours mean, and all values that they stand for: the ends of the scale are also the
/// colours of what is beyond them.
std::string scale_name(const std::string &quantity, const SeenValues &seen) {
  if (!(seen.low <= seen.high))
    return quantity;
  const auto text = [&](double value) {
    return number_text(value, seen.scale.logarithmic ? value / 100 : (seen.high - seen.low) / 1000);
  };
  return fmt::format("{}, {} to {} in all", quantity, text(seen.low), text(seen.high));
}

Meaning meaning_of(const Communicator &comm, const DistributedMesh &mesh, const Window &window,
                   const PictureOptions &options) {
  Meaning meaning;
  meaning.title = fmt::format("{}, {}, {}", counted(mesh.site_count(), "site"),
                              counted(mesh.triangle_count(), "triangle"), counted(mesh.slab_count(), "slab"));
  const auto explain = [&](const std::string &quantity, const SeenValues &seen) {
    meaning.name = scale_name(quantity, seen);
    meaning.scale = seen.scale;
  };
  switch (options.colouring) {
  case Colouring::slab:
    for (std::size_t s = 0; s + 1 < mesh.site_offsets.size(); ++s)
      meaning.slab_sites.push_back(mesh.site_offsets[s + 1] - mesh.site_offsets[s]);
    break;
  case Colouring::angle:
    meaning.name = "smallest angle (degrees)";
    meaning.scale = {0, 60, false};
    break;
  case Colouring::area:
    explain("area (logarithmic)",
            seen_values(comm, mesh, window, true, [](const Corners &c) { return c.doubled_area() / 2; }));
    break;
  case Colouring::elevation:
    explain("elevation (z)", seen_values(comm, mesh, window, false, mean_z));
    break;
  }
  GlobalIndex path_sites = 0;
  for (const SlabMesh &slab : mesh.slabs)
    path_sites += static_cast<GlobalIndex>(slab.left_path.size());
  path_sites = all_reduce_sum(comm, path_sites);
  if (options.paths)
    meaning.paths = fmt::format("{} of {}", counted(std::max(0, mesh.slab_count() - 1), "split path"),
                                counted(path_sites, "site"));
  if (options.hull)
    meaning.hull = "convex hull of " + counted(mesh.hull_edges, "edge");
  return meaning;
}

} // namespace

std::array<Point, 3> corners_in_pixels(const Scene &scene, const SlabMesh &slab, LocalIndex triangle) {
  std::array<Point, 3> corners{};
  for (std::size_t i = 0; i < 3; ++i)
    corners[i] =
        scene.layout.view.to_pixels(slab.vertices.points[at(slab.triangles.corners[3 * at(triangle) + i])]);
  return corners;
}

DrawnTriangle drawn_triangle(const Scene &scene, const SlabMesh &slab, LocalIndex triangle,
                             const std::array<Point, 3> &corners) {
  DrawnTriangle drawn{corners, paper, 0};
  const Corners real = corners_of(slab, triangle);
  switch (scene.options.colouring) {
  case Colouring::slab:
    drawn.colour = colour_of_slab(scene.mesh.first_slab + static_cast<int>(&slab - scene.mesh.slabs.data()));
    break;
  case Colouring::angle:
    drawn.colour = colour_at(scene.scale.position(smallest_angle(real)));
    break;
  case Colouring::area:
    drawn.colour = colour_at(scene.scale.position(real.doubled_area() / 2));
    break;
  case Colouring::elevation:
    drawn.colour =
        shaded(colour_at(scene.scale.position(mean_z(real))), brightness(gradient(real), scene.exaggeration));
    break;
  }
  constexpr double least_room = 5; // pixels
  const double size = std::sqrt(Corners{corners, {}}.doubled_area());
  const double unit = std::max(1.0, scene.layout.dot / 3.0);
  // Lines begin with no width, so that no border shows between where there are some and where there are none.
  if (size > least_room)
    drawn.edge_half_width = std::min((size - least_room) * 0.05, 0.6 * unit);
  return drawn;
}

Colour edge_colour(Colouring colouring) {
  return colouring == Colouring::slab ? Colour{255, 255, 255} : Colour{20, 20, 30};
}
int edge_weight(Colouring colouring) {
  switch (colouring) {
  case Colouring::slab:
    return 230;
  case Colouring::elevation:
    return 50;
  default:
    return 110;
  }
}
// The hull shows on both sides of a path that runs along it.
double hull_half_width(const Layout &layout) { return 0.7 + 0.9 * layout.dot; }
double path_half_width(const Layout &layout) { return std::max(0.6, 0.55 * layout.dot); }
double casing_half_width(const Layout &layout) { return std::max(1.2, 1.1 * layout.dot); }

} // namespace picture

void write_picture(const Communicator &comm, const DistributedMesh &mesh, const std::string &path,
                   const PictureOptions &options) {
  std::string extension = std::filesystem::path(path).extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (extension != ".png" && extension != ".svg")
    picture::refuse(path, "is not the name of a picture", "let it end in .png or .svg");
  const bool has_z =
      any_of_ranks(comm, std::any_of(mesh.slabs.begin(), mesh.slabs.end(),
                                     [](const auto &slab) { return picture::z_of(slab) != nullptr; }));
  picture::check_options(mesh, path, extension == ".svg", has_z, options);
  const std::optional<Window> box = picture::box_of(comm, mesh);
  if (!box)
    throw Error({ErrorKind::input, "the mesh", "", "has no sites, so there is nothing to draw", ""});
  const Window window = picture::window_of(*box, options);
  picture::Meaning meaning = picture::meaning_of(comm, mesh, window, options);
  meaning.part = picture::part_text(options.window ? *options.window : *box);
  picture::Scene scene{mesh, options, picture::lay_out(meaning, window, options.width), meaning.scale, 1, {}};
  if (options.colouring == Colouring::elevation)
    scene.exaggeration = picture::exaggeration_of(comm, mesh, window);
  if (options.paths)
    scene.paths = path_points(comm, mesh);
  if (extension == ".svg")
    picture::write_svg(comm, scene, path);
  else
    picture::write_png(comm, scene, path);
}

} // namespace dovetail
