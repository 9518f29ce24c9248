#include "dovetail/mesh/validate_domain.hpp"

#include "dovetail/geometry/predicates.hpp"
#include "dovetail/mesh/histogram.hpp"
#include "dovetail/mesh/quality.hpp"
#include "dovetail/mesh/validate.hpp"
#include "scale.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/core.h>

namespace dovetail {
namespace {

constexpr std::size_t index(LocalIndex i) { return static_cast<std::size_t>(i); }
constexpr std::size_t base_of(std::size_t side) { return side - side % 3; }
constexpr std::size_t next(std::size_t side) { return side % 3 == 2 ? side - 2 : side + 1; }
constexpr std::size_t previous(std::size_t side) { return side % 3 == 0 ? side + 2 : side - 1; }
constexpr LocalIndex triangle_of(std::size_t side) { return static_cast<LocalIndex>(side / 3); }
constexpr std::size_t nowhere = static_cast<std::size_t>(-1);

/// What rounding may move a Steiner point off its segment, in the greatest coordinate: each split may bend by
/// a unit in the last place or two, and there are some dozen splits one within the other.
constexpr double bend_allowed = 0x1p-45;

class DomainValidation {
public:
  DomainValidation(const DomainMesh &mesh, std::span<const Segment> segments, double min_angle,
                   std::size_t faults_kept)
      : mesh_(mesh), segments_(segments), bound_(min_angle), faults_kept_(faults_kept) {}

  DomainReport run() {
    if (!layout_fits()) {
      add(DomainFaultKind::layout, none, "arrays and indices do not fit each other");
      return std::move(report_);
    }
    for (const Point &p : mesh_.vertices)
      reach_ = std::max({reach_, std::fabs(p.x), std::fabs(p.y)});
    check_triangles();
    check_sides();
    if (report_.count(DomainFaultKind::adjacency) == 0)
      check_counts();
    check_chains();
    check_angles();
    return std::move(report_);
  }

private:
  void add(DomainFaultKind kind, LocalIndex triangle, std::string text) {
    ++report_.fault_count;
    ++report_.faults_by_kind[static_cast<std::size_t>(kind)];
    if (report_.first_faults.size() < faults_kept_)
      report_.first_faults.push_back({kind, triangle, std::move(text)});
  }

  LocalIndex corner(std::size_t side) const { return mesh_.triangles.corners[side]; }
  LocalIndex from(std::size_t side) const { return corner(next(side)); }
  LocalIndex to(std::size_t side) const { return corner(previous(side)); }
  LocalIndex segment(std::size_t side) const { return mesh_.segment_of_side[side]; }
  Point point(LocalIndex v) const { return mesh_.vertices[index(v)]; }
  Point apex(std::size_t side) const { return point(corner(side)); }

  /// The same edge as a side of the triangle beyond, `nowhere` on the boundary. Adjacency is symmetric.
  std::size_t twin(std::size_t side) const {
    const LocalIndex beyond = mesh_.triangles.neighbours[side];
    if (beyond == none)
      return nowhere;
    std::size_t back = 3 * index(beyond);
    while (from(back) != to(side) || to(back) != from(side))
      ++back;
    return back;
  }

  bool layout_fits() const {
    const std::size_t sides = mesh_.triangles.corners.size();
    const auto names_segment = [&](LocalIndex s) {
      return s == none || (s >= 0 && index(s) < segments_.size());
    };
    const auto names_vertex = [&](LocalIndex v) { return v >= 0 && index(v) < mesh_.vertices.size(); };
    return layout_is_sound(mesh_.vertices.size(), mesh_.triangles) && mesh_.segment_of_side.size() == sides &&
           mesh_.region.size() == sides / 3 && mesh_.vertex_markers.size() == mesh_.vertices.size() &&
           std::ranges::all_of(mesh_.segment_of_side, names_segment) &&
           std::ranges::all_of(segments_, [&](const Segment &s) {
             return names_vertex(s.from) && names_vertex(s.to) && s.from != s.to;
           });
  }

  void check_triangles() {
    CompensatedSum area;
    for (LocalIndex t = 0; t < mesh_.triangles.triangle_count(); ++t) {
      if (!is_counter_clockwise(mesh_.vertices, mesh_.triangles, t))
        add(DomainFaultKind::orientation, t, "not counter-clockwise");
      const std::size_t side = 3 * index(t);
      area.add(0.5 * doubled_area(apex(side), apex(side + 1), apex(side + 2)));
    }
    report_.area = area.value();
  }

  void check_sides() {
    for (std::size_t side = 0; side < mesh_.triangles.corners.size(); ++side) {
      const LocalIndex t = triangle_of(side);
      if (!adjacency_is_symmetric(mesh_.triangles, t, static_cast<int>(side % 3))) {
        add(DomainFaultKind::adjacency, t, fmt::format("its side {} is not answered", side % 3));
        continue;
      }
      const std::size_t beyond = twin(side);
      if (beyond == nowhere) {
        ++report_.boundary_edges;
        ++report_.pieces;
        if (segment(side) == none)
          add(DomainFaultKind::boundary, t, fmt::format("its side {} is no piece of a segment", side % 3));
      } else if (side < beyond) {
        check_edge(side, beyond);
      }
    }
  }

  void check_edge(std::size_t side, std::size_t beyond) {
    const LocalIndex t = triangle_of(side);
    if (segment(side) != segment(beyond)) {
      add(DomainFaultKind::segment, t,
          fmt::format("side {} is of segment {}, and of {} from beyond", side % 3, segment(side),
                      segment(beyond)));
    } else if (segment(side) != none) {
      ++report_.pieces;
    } else {
      ++report_.inner_edges;
      if (mesh_.region[index(t)] != mesh_.region[beyond / 3])
        add(DomainFaultKind::segment, t, fmt::format("two regions meet at side {} without one", side % 3));
      const std::size_t base = base_of(side);
      if (!is_locally_delaunay(apex(base), apex(base + 1), apex(base + 2), apex(beyond)))
        add(DomainFaultKind::delaunay, t,
            fmt::format("vertex {} beyond side {} is inside its circle", corner(beyond), side % 3));
    }
  }

  void check_counts() {
    count_components();
    const GlobalIndex fans = count_fans();
    count_boundaries();
    report_.pinched = fans - report_.vertices;
    const GlobalIndex edges = report_.inner_edges + report_.pieces;
    const GlobalIndex triangles = mesh_.triangles.triangle_count();
    if (fans - edges + triangles != 2 * report_.components - report_.boundaries)
      add(DomainFaultKind::euler, none,
          fmt::format("{} vertices with {} pinches, {} edges and {} triangles in {} components with {} "
                      "boundaries: these are not plane",
                      report_.vertices, report_.pinched, edges, triangles, report_.components,
                      report_.boundaries));
  }

  void count_components() {
    std::vector<bool> met(mesh_.region.size(), false);
    std::vector<LocalIndex> reached;
    for (LocalIndex t = 0; t < mesh_.triangles.triangle_count(); ++t) {
      if (met[index(t)])
        continue;
      ++report_.components;
      met[index(t)] = true;
      reached.assign(1, t);
      while (!reached.empty()) {
        const std::size_t side = 3 * index(reached.back());
        reached.pop_back();
        for (std::size_t i = side; i < side + 3; ++i)
          if (const LocalIndex beyond = mesh_.triangles.neighbours[i];
              beyond != none && !met[index(beyond)]) {
            met[index(beyond)] = true;
            reached.push_back(beyond);
          }
      }
    }
  }

  /// Triangles around a vertex, connected by sides: one fan, or several where the domain is pinched. Together
  /// they must not go around more than once: of all corners at a vertex at most one has the direction that is
  /// followed by lexicographically smaller points.
  GlobalIndex count_fans() {
    std::vector<bool> met(mesh_.triangles.corners.size(), false); // by corner
    std::vector<std::uint8_t> fans(mesh_.vertices.size(), 0), turns(mesh_.vertices.size(), 0);
    GlobalIndex count = 0;
    for (std::size_t c = 0; c < met.size(); ++c) {
      const LocalIndex v = corner(c);
      if (lexicographically_less(point(v), point(from(c))) &&
          lexicographically_less(point(to(c)), point(v)) && ++turns[index(v)] > 1)
        add(DomainFaultKind::euler, triangle_of(c), fmt::format("triangles overlap at vertex {}", v));
      if (met[c])
        continue;
      ++count;
      report_.vertices += fans[index(v)]++ == 0 ? 1 : 0;
      mark_fan(c, met);
    }
    return count;
  }

  /// All corners that are reached from this one across sides that end in its vertex.
  void mark_fan(std::size_t c, std::vector<bool> &met) const {
    std::size_t at = c;
    do {
      met[at] = true;
      const std::size_t beyond = twin(next(at));
      if (beyond == nowhere)
        break;
      at = next(beyond);
    } while (at != c);
    for (at = twin(previous(c)); at != nowhere && !met[previous(at)]; at = twin(previous(at))) {
      at = previous(at);
      met[at] = true;
    }
  }

  /// The boundary side after one, around its end within the domain.
  std::size_t boundary_after(std::size_t side) const {
    std::size_t at = next(side);
    for (std::size_t beyond = twin(at); beyond != nowhere; beyond = twin(at))
      at = next(beyond);
    return at;
  }

  void count_boundaries() {
    std::vector<bool> met(mesh_.triangles.corners.size(), false);
    CompensatedSum straight;
    double length = 0;
    const Point origin = mesh_.vertices.empty() ? Point{0, 0} : mesh_.vertices.front();
    for (std::size_t side = 0; side < met.size(); ++side) {
      if (mesh_.triangles.neighbours[side] != none || met[side])
        continue;
      ++report_.boundaries;
      std::size_t at = side;
      do {
        met[at] = true;
        add_straight(at, origin, straight);
        length += distance(point(from(at)), point(to(at)));
        at = boundary_after(at);
      } while (at != side);
    }
    const double allowed = bend_allowed * reach_ * length + 0x1p-40 * std::fabs(straight.value());
    if (std::fabs(straight.value() - report_.area) > allowed)
      add(DomainFaultKind::area, none,
          fmt::format("triangles cover {:.17g}, the domain has {:.17g}", report_.area, straight.value()));
  }

  /// The contribution of a boundary side to the area between straight segments: the piece is replaced by its
  /// projection to the segment.
  void add_straight(std::size_t side, Point origin, CompensatedSum &area) const {
    Displacement a = point(from(side)) - origin, b = point(to(side)) - origin;
    if (segment(side) != none) {
      const Segment &s = segments_[index(segment(side))];
      const Displacement start = point(s.from) - origin;
      const Displacement way = point(s.to) - point(s.from);
      for (Displacement *d : {&a, &b}) {
        const Displacement rest{d->x - start.x, d->y - start.y};
        const double fraction = dot(rest, way) / squared_length(way);
        *d = {start.x + fraction * way.x, start.y + fraction * way.y};
      }
    }
    area.add(0.5 * cross(a, b));
  }

  struct Piece {
    LocalIndex segment;
    double place; ///< of its earlier end, from 0 to 1 along the segment
    LocalIndex from, to;
  };

  /// Whatever the size of coordinates.
  double place(const Segment &s, LocalIndex v) const {
    const Displacement way = point(s.to) - point(s.from), part = point(v) - point(s.from);
    const double reach = std::max(std::fabs(way.x), std::fabs(way.y));
    const Displacement direction{way.x / reach, way.y / reach};
    return v == s.to ? 1 : dot({part.x / reach, part.y / reach}, direction) / squared_length(direction);
  }

  void check_chains() {
    std::vector<Piece> pieces;
    for (std::size_t side = 0; side < mesh_.segment_of_side.size(); ++side) {
      const LocalIndex s = segment(side), beyond = mesh_.triangles.neighbours[side];
      if (s == none || (beyond != none && triangle_of(side) > beyond))
        continue;
      const double of_from = place(segments_[index(s)], from(side)),
                   of_to = place(segments_[index(s)], to(side));
      if (of_from < of_to)
        pieces.push_back({s, of_from, from(side), to(side)});
      else
        pieces.push_back({s, of_to, to(side), from(side)});
    }
    std::ranges::sort(pieces, [](const Piece &a, const Piece &b) {
      return a.segment != b.segment ? a.segment < b.segment : a.place < b.place;
    });
    std::size_t first = 0;
    for (std::size_t s = 0; s < segments_.size(); ++s) {
      std::size_t end = first;
      while (end < pieces.size() && index(pieces[end].segment) == s)
        ++end;
      if (first == end)
        ++report_.missing_segments;
      else
        check_chain(segments_[s], std::span(pieces).subspan(first, end - first));
      first = end;
    }
  }

  void check_chain(const Segment &s, std::span<const Piece> chain) {
    const LocalIndex number = chain.front().segment;
    LocalIndex at = s.from;
    for (const Piece &piece : chain) {
      if (piece.from != at) {
        add(DomainFaultKind::chain, none,
            fmt::format("segment {} has no piece from vertex {} on", number, at));
        return;
      }
      at = piece.to;
      const Displacement way = point(s.to) - point(s.from);
      const double length = std::sqrt(squared_length(way));
      const double off = std::fabs(cross(way, point(at) - point(s.from))) / length;
      report_.bend = std::max(report_.bend, off / length);
      if (at != s.to && off > bend_allowed * reach_)
        add(DomainFaultKind::chain, none, fmt::format("vertex {} is not on segment {}", at, number));
    }
    if (at != s.to)
      add(DomainFaultKind::chain, none, fmt::format("segment {} ends in vertex {}", number, at));
  }

  void check_angles() {
    const SmallAngles small_angles(mesh_.vertices, segments_);
    const std::vector<LocalIndex> on = segments_of_vertices(mesh_, segments_);
    for (LocalIndex t = 0; t < mesh_.triangles.triangle_count(); ++t) {
      const std::size_t side = 3 * index(t);
      const Point a = apex(side), b = apex(side + 1), c = apex(side + 2);
      const double angle = smallest_angle(a, b, c);
      report_.smallest_angle = std::min(report_.smallest_angle, angle);
      if (!bound_.is_below(squared_sides(a, b, c)))
        continue;
      if (is_exempt(mesh_, t, small_angles, on))
        ++report_.exempt_triangles;
      else
        add(DomainFaultKind::angle, t,
            fmt::format("an angle of {} degrees, where {} were asked for", angle, bound_.degrees()));
    }
  }

  const DomainMesh &mesh_;
  std::span<const Segment> segments_;
  AngleBound bound_;
  std::size_t faults_kept_;
  double reach_ = 0;
  DomainReport report_;
};

} // namespace

std::string_view name_of(DomainFaultKind kind) {
  static constexpr std::array<std::string_view, domain_fault_kinds> names{
      "layout",  "orientation", "adjacency", "delaunay", "boundary",
      "segment", "chain",       "area",      "euler",    "angle"};
  return names[static_cast<std::size_t>(kind)];
}

DomainReport validate_domain(const DomainMesh &mesh, std::span<const Segment> segments, double min_angle,
                             std::size_t faults_kept) {
  const int exponent = scale_exponent(mesh.vertices).value_or(0); // nothing of such sizes was refined
  if (exponent == 0)
    return DomainValidation(mesh, segments, min_angle, faults_kept).run();
  DomainMesh scaled = mesh;
  scale(scaled.vertices, -exponent);
  DomainReport report = DomainValidation(scaled, segments, min_angle, faults_kept).run();
  report.area = std::ldexp(report.area, 2 * exponent);
  return report;
}

} // namespace dovetail
