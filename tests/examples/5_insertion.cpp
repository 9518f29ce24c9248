// One insertion, step by step, drawn as an animated SVG on standard output: the walk to the new site, the
// cavity, and the flips that lead from three new edges to the same star that the cavity formulation makes at
// once. Needs the kernel alone.
//
//     example_insertion > insertion.svg
#include <dovetail/geometry/distributions.hpp>
#include <dovetail/mesh/divide_and_conquer.hpp>
#include <dovetail/mesh/flip.hpp>
#include <dovetail/mesh/validate.hpp>

#include <cstdio>
#include <fmt/format.h>
#include <string>
#include <vector>

using namespace dovetail;

namespace {

constexpr double width = 640, height = 500, map_height = 460, margin = 20;
constexpr double seconds_a_frame = 1.1;

/// What a moment of the insertion looks like.
struct Frame {
  std::string caption;
  std::string shapes; ///< SVG
};

struct Drawing {
  const std::vector<Point> &sites;
  Point site;
  std::vector<Frame> frames;

  /// From the unit square to pixels, y downwards.
  static std::string at(Point p) {
    return fmt::format("{:.1f} {:.1f}", margin + p.x * (width - 2 * margin),
                       map_height - margin - p.y * (map_height - 2 * margin));
  }
  std::string corner(const Triangulation &mesh, HalfEdge h) const {
    return at(sites[position(apex(mesh, h))]);
  }

  std::string line(const Triangulation &mesh, HalfEdge h) const {
    return fmt::format("M{}L{}", corner(mesh, after(h)), corner(mesh, before(h)));
  }
  std::string edge(const Triangulation &mesh, HalfEdge h, const char *kind) const {
    return fmt::format("<path class=\"{}\" d=\"{}\"/>\n", kind, line(mesh, h));
  }
  std::string all_edges(const Triangulation &mesh) const {
    std::string lines;
    for (HalfEdge h = 0; position(h) < mesh.corners.size(); ++h)
      if (twin(mesh, h) < h) // each once
        lines += line(mesh, h);
    return fmt::format("<path class=\"edges\" d=\"{}\"/>\n", lines);
  }
  std::string triangles(const Triangulation &mesh, const std::vector<LocalIndex> &some,
                        const char *fill) const {
    std::string outlines;
    for (const LocalIndex t : some)
      outlines += fmt::format("M{}L{}L{}Z", corner(mesh, half_edge(t, 0)), corner(mesh, half_edge(t, 1)),
                              corner(mesh, half_edge(t, 2)));
    return fmt::format("<path fill=\"{}\" d=\"{}\"/>\n", fill, outlines);
  }
  std::string boundary(const Cavity &cavity) const {
    std::string outline;
    for (const CavityEdge &edge : cavity.edges)
      outline += fmt::format("{}{}", outline.empty() ? "M" : "L", at(sites[position(edge.from)]));
    return fmt::format("<path class=\"cavity\" d=\"{}Z\"/>\n", outline);
  }

  void add(std::string caption, std::string shapes) {
    frames.push_back({std::move(caption), std::move(shapes)});
  }
  void print() const;
};

/// A frame is visible for its part of the time; where nothing moves, the last one is.
void Drawing::print() const {
  fmt::print(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0} {1}\" width=\"{0}\" height=\"{1}\">\n"
      "<style>.edges{{stroke:#8a8a8a;fill:none}}.cavity{{stroke:#994455;stroke-width:3;fill:none;"
      "stroke-linejoin:round}}.old{{stroke:#994455;stroke-width:3;stroke-dasharray:5 5}}"
      ".new{{stroke:#1f5f8b;stroke-width:3}}text{{font:16px monospace;fill:#282828}}</style>\n"
      "<rect width=\"{0}\" height=\"{1}\" fill=\"#ffffff\"/>\n",
      width, height);
  const auto count = static_cast<double>(frames.size() + 1); // the last one stays longer
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const bool is_last = i + 1 == frames.size();
    const auto begin = static_cast<double>(i) / count, end = is_last ? 1 : static_cast<double>(i + 1) / count;
    fmt::print("<g visibility=\"{}\">\n<animate attributeName=\"visibility\" calcMode=\"discrete\" "
               "values=\"{};visible;{}\" keyTimes=\"0;{:.4f};{:.4f}\" dur=\"{:.1f}s\" "
               "repeatCount=\"indefinite\"/>\n",
               is_last ? "visible" : "hidden", i == 0 ? "visible" : "hidden", is_last ? "visible" : "hidden",
               begin, end, seconds_a_frame * count);
    fmt::print("{}<text x=\"{}\" y=\"{}\">{}</text>\n</g>\n", frames[i].shapes, margin, height - 14,
               frames[i].caption);
  }
  std::string dots;
  for (const Point &other : sites)
    if (other != site)
      dots += fmt::format("M{}h0", at(other));
  fmt::print("<path d=\"{}\" stroke=\"#282828\" stroke-width=\"6\" stroke-linecap=\"round\"/>\n"
             "<path d=\"M{}h0\" stroke=\"#994455\" stroke-width=\"12\" stroke-linecap=\"round\"/>\n</svg>\n",
             dots, at(site));
}

constexpr const char *walk_colour = "#d6e6f2", *cavity_colour = "#f2d9de", *star_colour = "#dcefdc";

/// The triangles of a walk, from the hint on: the predicate for locked edges hears of every step.
std::vector<LocalIndex> walk(const std::vector<Point> &sites, const Triangulation &mesh, Point site,
                             LocalIndex hint, Place &place) {
  std::vector<LocalIndex> way{hint};
  place = locate(sites, mesh, site, hint, [&](LocalIndex triangle, int side) {
    const LocalIndex ahead = mesh.neighbours[position(half_edge(triangle, side))];
    if (way.back() == triangle && ahead != none)
      way.push_back(ahead);
    return false;
  });
  return way;
}

/// Joins the site with the corners of its triangle, and draws every flip.
void flip_one_by_one(Drawing &drawing, Triangulation &mesh, const Place &place, LocalIndex vertex,
                     const std::string &outline) {
  const auto everything_is_locked = [](LocalIndex, int) { return true; };
  Cavity corners;
  find_cavity(drawing.sites, mesh, drawing.site, place, corners, everything_is_locked);
  const LocalIndex first_new = commit(mesh, corners, vertex);
  std::vector<HalfEdge> suspicious;
  for (std::size_t e = 0; e < corners.edges.size(); ++e)
    suspicious.push_back(half_edge(star_triangle(corners, first_new, e), 0));
  drawing.add("the other way: joined with the corners around", drawing.all_edges(mesh) + outline);
  int flips = 0;
  while (!suspicious.empty()) {
    const HalfEdge h = suspicious.back();
    const HalfEdge across = twin(mesh, h);
    suspicious.pop_back();
    if (across == none || !is_in_circle(drawing.sites, mesh, triangle_of(across), drawing.site))
      continue;
    const std::string old = drawing.edge(mesh, h, "old");
    flip(mesh, h);
    const LocalIndex t = triangle_of(h), u = triangle_of(across);
    drawing.add(fmt::format("flip {}", ++flips), drawing.triangles(mesh, {t, u}, star_colour) +
                                                     drawing.all_edges(mesh) + old +
                                                     drawing.edge(mesh, half_edge(t, 1), "new") + outline);
    suspicious.push_back(half_edge(t, 0));
    suspicious.push_back(half_edge(u, 0));
  }
  drawing.add(fmt::format("after {} flips: the same star", flips), drawing.all_edges(mesh) + outline);
}

} // namespace

int main() {
  std::vector<Point> sites(36);
  generate_points({Distribution::uniform, static_cast<GlobalIndex>(sites.size()), 12}, 0, sites);
  Triangulation mesh = delaunay(sites);
  const Point site{0.64, 0.5};
  const LocalIndex hint = locate(sites, mesh, {0.15, 0.3}, 0).triangle;

  Place place;
  const std::vector<LocalIndex> way = walk(sites, mesh, site, hint, place);
  Cavity cavity;
  find_cavity(sites, mesh, site, place, cavity);
  const auto vertex = static_cast<LocalIndex>(sites.size());
  sites.push_back(site);

  Drawing drawing{sites, site, {}};
  const std::string before = drawing.all_edges(mesh);
  for (std::size_t i = 1; i <= way.size(); ++i)
    drawing.add(
        "locate: triangle " + std::to_string(i) + " of the walk",
        drawing.triangles(mesh, {way.begin(), way.begin() + static_cast<std::ptrdiff_t>(i)}, walk_colour) +
            before);
  const std::string outline = drawing.boundary(cavity);
  drawing.add("cavity: the " + std::to_string(cavity.triangles.size()) +
                  " triangles whose circles hold the site",
              drawing.triangles(mesh, cavity.triangles, cavity_colour) + before + outline);

  Triangulation committed = mesh;
  const LocalIndex first_new = commit(committed, cavity, vertex);
  std::vector<LocalIndex> star;
  for (std::size_t e = 0; e < cavity.edges.size(); ++e)
    star.push_back(star_triangle(cavity, first_new, e));
  drawing.add("commit: the star of the site takes its place",
              drawing.triangles(committed, star, star_colour) + drawing.all_edges(committed) + outline);

  flip_one_by_one(drawing, mesh, place, vertex, outline);
  drawing.print();
  return validate(sites, mesh).valid() && validate(sites, committed).valid() ? 0 : 1;
}
