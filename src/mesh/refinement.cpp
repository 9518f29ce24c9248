#include "refinement.hpp"

#include "dovetail/base/huge_pages.hpp"
#include "dovetail/geometry/predicates.hpp"

#include <algorithm>
#include <cmath>

namespace dovetail {
namespace {

constexpr std::size_t index(LocalIndex i) { return static_cast<std::size_t>(i); }

std::uint64_t key_of(LocalIndex a, LocalIndex b) {
  const auto [low, high] = std::minmax(a, b);
  return static_cast<std::uint64_t>(high) << 32 | static_cast<std::uint64_t>(low);
}

bool is_finite(Point p) { return std::isfinite(p.x) && std::isfinite(p.y); }

/// Off-centers are made a little nearer than the bound allows, so that rounding does not leave a triangle
/// just below it. Smaller values make more points: 0.95 1.5 % more at 30 degrees.
constexpr double safely_within = 0.99;

/// So many that arrays seldom have to grow. Pages that are not used cost nothing but addresses, and these may
/// be limited, too: there is no room for what other options keep from being made, and an area limit does not
/// ask for more than half a gigabyte of faces, and as much again for what goes with them.
std::size_t expected_faces(const DomainMesh &mesh, const RefineOptions &options) {
  constexpr double by_angle = 3, by_area = 1.75; // 2.75 and 1.6 are usual at 30 degrees
  constexpr double most_by_area = 1 << 24;
  const auto given = static_cast<double>(mesh.triangles.triangle_count());
  double area = 0;
  for (std::size_t i = 0; options.max_area > 0 && i < mesh.triangles.corners.size(); i += 3) {
    const LocalIndex *const corner = &mesh.triangles.corners[i];
    area += 0.5 * doubled_area(mesh.vertices[index(corner[0])], mesh.vertices[index(corner[1])],
                               mesh.vertices[index(corner[2])]);
  }
  // Points that are no nearer to each other than min_edge make triangles of this area where they are densest.
  const double densest = std::sqrt(3.0) / 4 * options.min_edge * options.min_edge;
  const double of_area =
      options.max_area > 0 ? std::min(by_area * area / std::max(options.max_area, densest), most_by_area) : 0;
  return static_cast<std::size_t>(
      std::min({std::max(by_angle * given, of_area), 2.0 * options.max_points, 1.0 * most_faces}));
}

} // namespace

Refinement::Refinement(DomainMesh mesh, std::span<const Segment> segments, const RefineOptions &options,
                       const SizeField *size_field)
    : options_(options), size_field_(size_field), segments_(segments), bound_(options.min_angle),
      max_area_(options.max_area > 0 ? options.max_area : HUGE_VAL), small_angles_(mesh.vertices, segments),
      given_markers_(std::move(mesh.vertex_markers)), faces_(faces_of(mesh, expected_faces(mesh, options))),
      tiles_(mesh.vertices, options.max_area), skinny_(tiles_.count()), search_(vertices_, faces_) {
  number_vertices(mesh);
  if (options.locked)
    lock(options.locked);
  double reach = 0;
  for (const Point &p : vertices_)
    reach = std::max({reach, std::fabs(p.x), std::fabs(p.y)});
  floor_ = std::max(std::ldexp(reach, -44) * std::ldexp(reach, -44), 0x1p-1000);
}

/// Vertices in the order in which triangles meet them: what is near is then near in memory. Vertices in no
/// triangle come last.
void Refinement::number_vertices(const DomainMesh &mesh) {
  std::vector<LocalIndex> number(mesh.vertices.size(), none);
  given_number_.reserve(mesh.vertices.size());
  const auto meet = [&](LocalIndex v) {
    if (number[index(v)] == none) {
      number[index(v)] = static_cast<LocalIndex>(given_number_.size());
      given_number_.push_back(v);
    }
    return number[index(v)];
  };
  for (Face &face : faces_.faces)
    for (LocalIndex &v : face.corner)
      v = meet(v);
  for (LocalIndex v = 0; index(v) < mesh.vertices.size(); ++v)
    meet(v);
  const std::size_t faces = faces_.faces.capacity();
  reserve_huge(vertices_, std::max(mesh.vertices.size(), faces / 2 + faces / 16));
  reserve_huge(segment_of_vertex_, vertices_.capacity());
  const std::vector<LocalIndex> given_segments = segments_of_vertices(mesh, segments_);
  for (const LocalIndex v : given_number_) {
    vertices_.push_back(mesh.vertices[index(v)]);
    segment_of_vertex_.push_back(given_segments[index(v)]);
  }
}

void Refinement::lock(const std::function<bool(LocalIndex, int)> &locked) {
  for (LocalIndex t = 0; t < faces_.count(); ++t)
    for (int i = 0; i < 3; ++i)
      if (faces_.twin(4 * t + i) != none && locked(t, i))
        faces_.face(t).locked_sides = static_cast<std::uint8_t>(faces_.face(t).locked_sides | 1 << i);
}

void Refinement::run() {
  look_at_all();
  std::size_t steps = 0;
  while (!full_) {
    if (!encroached_.empty()) {
      split_encroached();
    } else if (!skinny_.empty()) {
      insert_inside(skinny_.pop(
          [this](const SkinnyQueue::Entry &soon) { __builtin_prefetch(&faces_.face(soon.face)); }));
    } else if (!try_again()) {
      break;
    }
    if (++steps % 65536 == 0) {
      const auto done = static_cast<double>(steps);
      report_progress(options_.progress, "refine", done / (done + static_cast<double>(skinny_.size())));
    }
  }
}

/// What was left for want of precision, if there are new points since. A rounded point beside a subsegment
/// may have been outside of the circle of a needle there; by now there may be a better triangle. False if
/// nothing is to be tried.
bool Refinement::try_again() {
  constexpr int most_tries = 8; // one or two do in practice
  if ((left_triangles_.empty() && left_segments_.empty()) || vertices_.size() == tried_vertices_ ||
      tries_++ == most_tries)
    return false;
  tried_vertices_ = vertices_.size();
  tile_ = 0;
  for (LocalIndex t = 0; t < faces_.count(); ++t) {
    for (HalfEdge h = 4 * t; h < 4 * t + 3; ++h)
      if (faces_.is_segment(h) && h > faces_.twin(h) && left_reason(h) == LeftReason::precision)
        encroached_.push_back({h, faces_.from(h), faces_.to(h), tile_});
    const auto left = left_triangles_.find(t);
    if (left == left_triangles_.end() || left->second.reason != LeftReason::precision ||
        left->second.corner != faces_.face(t).corner)
      continue;
    left_triangles_.erase(left);
    const Shape shape = shape_of(faces_.face(t));
    look_at_triangle(t, shape, tiles_.of_new(shape.a, tile_));
  }
  std::erase_if(left_segments_, [](const auto &left) { return left.second == LeftReason::precision; });
  return !encroached_.empty() || !skinny_.empty();
}

void Refinement::look_at_all() {
  for (LocalIndex t = 0; t < faces_.count(); ++t) {
    const Face &face = faces_.face(t);
    tile_ = tiles_.of_given(face.corner[0]);
    const Shape shape = shape_of(face);
    look_at_triangle(t, shape, tiles_.of_new(shape.a, tile_));
    if (face.segment_sides != 0)
      for (HalfEdge h = 4 * t; h < 4 * t + 3; ++h)
        if (faces_.is_segment(h))
          look_at_subsegment(h);
  }
}

/// From the left side; the other side looks for itself.
void Refinement::look_at_subsegment(HalfEdge h) {
  const LocalIndex from = faces_.from(h), to = faces_.to(h);
  const Point apex = point(faces_.apex(h));
  if (dot(point(from) - apex, point(to) - apex) < 0)
    encroached_.push_back({h, from, to, tile_});
}

void Refinement::look_at_triangle(LocalIndex t, const Shape &shape, SkinnyQueue::Tile tile) {
  if (is_bad(t, shape))
    skinny_.push(shape.sides.least(), tile, {t, faces_.face(t).corner[0]});
}

bool Refinement::is_bad(LocalIndex t, const Shape &shape) const {
  // Both before either is branched upon: one guess for the two of them.
  const bool is_large = shape.area > max_area_, is_skinny = bound_.is_below(shape.sides);
  if (is_large | is_skinny)
    if (is_large || !is_exempt(t, shape.sides.shortest()))
      return true;
  return is_too_large_for_its_place(t, shape);
}

bool Refinement::is_exempt(LocalIndex t, std::size_t shortest) const {
  const Face &face = faces_.face(t);
  const std::size_t i = (shortest + 1) % 3, j = (shortest + 2) % 3;
  if ((face.segment_sides >> i & 1) != 0 && (face.segment_sides >> j & 1) != 0)
    return true;
  if (small_angles_.none_at_all())
    return false;
  const LocalIndex p = face.corner[i], q = face.corner[j];
  return small_angles_.on_one_shell(point(p), segment_of_vertex_[index(p)], point(q),
                                    segment_of_vertex_[index(q)]);
}

bool Refinement::is_too_large(LocalIndex t, const Shape &shape) const {
  return shape.area > max_area_ || is_too_large_for_its_place(t, shape);
}

/// The size field tells edges; a triangle counts as an equilateral one of its area.
bool Refinement::is_too_large_for_its_place(LocalIndex t, const Shape &shape) const {
  if (!options_.max_area_of_region.empty())
    if (const std::int32_t region = faces_.face(t).region;
        region != none && index(region) < options_.max_area_of_region.size())
      if (const double own = options_.max_area_of_region[index(region)]; own > 0 && shape.area > own)
        return true;
  return size_field_ != nullptr && size_field_->forbids(barycentre(shape.a, shape.b, shape.c),
                                                        std::sqrt(4 / std::sqrt(3.0) * shape.area));
}

void Refinement::look_at_fan(const SteinerCavity &cavity, Point p) {
  const std::size_t count = cavity.edge_count();
  const SkinnyQueue::Tile tile = tiles_.of_new(p, tile_);
  for (std::size_t k = 0; k < count; ++k) {
    const RimEdge &edge = cavity.rim[k], &after = cavity.rim[k + 1];
    const LocalIndex t = cavity.faces[k];
    look_at_triangle(t,
                     {p,
                      edge.from_point,
                      after.from_point,
                      {{squared_distance(edge.from_point, after.from_point), after.squared_distance,
                        edge.squared_distance}},
                      0.5 * edge.doubled_area},
                     tile);
    if (edge.segment != none)
      look_at_subsegment(4 * t);
  }
  if (cavity.open && count > 0) {
    look_at_subsegment(4 * cavity.faces.front() + 2);
    look_at_subsegment(4 * cavity.faces[count - 1] + 1);
  }
}

void Refinement::split_encroached() {
  const Subsegment subsegment = encroached_.back();
  encroached_.pop_back();
  tile_ = subsegment.tile;
  const HalfEdge h = subsegment.side;
  if (faces_.is_segment(h) && faces_.from(h) == subsegment.from && faces_.to(h) == subsegment.to)
    split(h);
}

/// A point may stand for one of the subsegment if the bend sweeps no vertex: it is on the subsegment, or
/// strictly inside one of the triangles beside it.
bool Refinement::fits(HalfEdge h, Point p) const {
  const Point a = point(faces_.from(h)), b = point(faces_.to(h));
  const Sign side = orientation(a, b, p);
  if (side == Sign::zero)
    return lexicographically_less(a, b) ? lexicographically_less(a, p) && lexicographically_less(p, b)
                                        : lexicographically_less(b, p) && lexicographically_less(p, a);
  const HalfEdge within = side == Sign::positive ? h : faces_.twin(h);
  if (within == none)
    return false;
  const Point from = point(faces_.from(within)), to = point(faces_.to(within)),
              apex = point(faces_.apex(within));
  return orientation(to, apex, p) == Sign::positive && orientation(apex, from, p) == Sign::positive;
}

/// The middle; or, of a subsegment with a sharp vertex at one end, the power of two nearest to it as distance
/// from there. Where rounding puts it out of bounds, a neighbour.
std::optional<Point> Refinement::split_point(HalfEdge h) const {
  LocalIndex a = faces_.from(h), b = faces_.to(h);
  const auto sharp = [&](LocalIndex v) {
    return segment_of_vertex_[index(v)] == input_vertex && small_angles_.is_sharp(given_number_[index(v)]);
  };
  double fraction = 0.5;
  if (sharp(a) != sharp(b)) {
    if (sharp(b))
      std::swap(a, b);
    const double length = distance(point(a), point(b));
    fraction = std::exp2(std::round(std::log2(length / 2))) / length;
  }
  const Point p = between(point(a), point(b), fraction);
  if (!is_finite(p))
    return {};
  const double reach = distance(point(a), point(b));
  const double step_x = std::max(std::fabs(p.x), reach) * 0x1p-52;
  const double step_y = std::max(std::fabs(p.y), reach) * 0x1p-52;
  for (const Displacement step : {Displacement{0, 0}, {step_x, 0}, {-step_x, 0}, {0, step_y}, {0, -step_y}})
    if (fits(h, p + step))
      return p + step;
  return {};
}

double Refinement::least_squared_distance(const SteinerCavity &cavity) const {
  double least = HUGE_VAL;
  for (const RimEdge &edge : cavity.rim)
    least = std::min(least, edge.squared_distance);
  return least;
}

std::optional<LeftReason> Refinement::too_near(double squared_distance) const {
  if (!(squared_distance >= floor_))
    return LeftReason::precision;
  if (squared_distance < options_.min_edge * options_.min_edge)
    return LeftReason::min_edge;
  return {};
}

void Refinement::split(HalfEdge h) {
  const HalfEdge twin = faces_.twin(h);
  const std::optional<Point> p = split_point(h);
  if (!p || !search_.find_half(h, *p, cavity_))
    return leave_subsegment(h, LeftReason::precision);
  right_cavity_.rim.clear();
  right_cavity_.locked = false;
  if (twin != none && !search_.find_half(twin, *p, right_cavity_))
    return leave_subsegment(h, LeftReason::precision);
  if (cavity_.locked || right_cavity_.locked)
    return leave_subsegment(h, LeftReason::locked);
  if (const auto reason =
          too_near(std::min(least_squared_distance(cavity_), least_squared_distance(right_cavity_))))
    return leave_subsegment(h, *reason);
  const LocalIndex v = add_vertex(*p, cavity_.segment);
  if (v == none)
    return;
  commit_halves(cavity_, right_cavity_, v, faces_);
  look_at_fan(cavity_, *p);
  look_at_fan(right_cavity_, *p);
}

/// Whether p, whose cavity was found, encroaches on subsegments, or lies beyond one: these are in blocking_.
bool Refinement::encroaches(Point p) {
  blocking_.clear();
  for (std::size_t k = 0; k < cavity_.edge_count(); ++k) {
    const RimEdge &edge = cavity_.rim[k], &after = cavity_.rim[k + 1];
    if (edge.segment != none && (dot(edge.from_point - p, after.from_point - p) < 0 ||
                                 orientation(edge.from_point, after.from_point, p) != Sign::positive))
      blocking_.push_back({edge.inside, edge.from, after.from, tile_});
  }
  return !blocking_.empty();
}

void Refinement::insert_inside(const SkinnyQueue::Waiting &waiting) {
  const LocalIndex t = waiting.entry.face;
  const std::array<LocalIndex, 3> &corner = faces_.face(t).corner;
  if (corner[0] != waiting.entry.corner)
    return;
  tile_ = waiting.tile;
  const std::array<Point, 3> at{point(corner[0]), point(corner[1]), point(corner[2])};
  const SquaredSides sides = squared_sides(at[0], at[1], at[2]);
  const std::size_t i = sides.shortest();
  const Point p = off_center(at[(i + 1) % 3], at[(i + 2) % 3], at[i], safely_within * bound_.reach());
  if (!is_finite(p) || !search_.find(t, p, cavity_))
    return leave(t, LeftReason::precision);
  if (cavity_.locked)
    return leave(t, LeftReason::locked);
  if (encroaches(p)) {
    std::optional<LeftReason> reason;
    for (const Subsegment &subsegment : blocking_) {
      const auto left = left_segments_.find(key_of(subsegment.from, subsegment.to));
      if (left == left_segments_.end())
        encroached_.push_back(subsegment);
      else
        reason = left->second;
    }
    if (encroached_.empty())
      return leave(t, *reason);
    return skinny_.push(sides.side[i], waiting.tile, waiting.entry);
  }
  if (const auto reason = too_near(least_squared_distance(cavity_)))
    return leave(t, *reason);
  const LocalIndex v = add_vertex(p, none);
  if (v == none)
    return;
  commit(cavity_, v, faces_);
  look_at_fan(cavity_, p);
}

LocalIndex Refinement::add_vertex(Point p, LocalIndex segment) {
  if (vertices_.size() >= index(options_.max_points) || faces_.faces.size() + 8 > most_faces) {
    full_ = true;
    return none;
  }
  if (vertices_.size() == vertices_.capacity()) {
    reserve_huge(vertices_, 2 * vertices_.size());
    reserve_huge(segment_of_vertex_, vertices_.capacity());
  }
  vertices_.push_back(p);
  segment_of_vertex_.push_back(segment);
  return static_cast<LocalIndex>(vertices_.size() - 1);
}

void Refinement::leave(LocalIndex t, LeftReason reason) {
  left_triangles_.insert_or_assign(t, Left{faces_.face(t).corner, reason});
}

std::optional<LeftReason> Refinement::left_reason(HalfEdge h) const {
  const auto left = left_segments_.find(key_of(faces_.from(h), faces_.to(h)));
  return left == left_segments_.end() ? std::optional<LeftReason>() : left->second;
}

void Refinement::leave_subsegment(HalfEdge h, LeftReason reason) {
  left_segments_.insert_or_assign(key_of(faces_.from(h), faces_.to(h)), reason);
}

} // namespace dovetail
