#include "carve.hpp"

#include "dovetail/geometry/predicates.hpp"

#include <algorithm>
#include <optional>

namespace dovetail {
namespace {

constexpr std::array<HalfEdge, 3> sides_of(LocalIndex face) { return {4 * face, 4 * face + 1, 4 * face + 2}; }

/// Visits what is reached from the given faces without crossing a side that `bars`, where `enter` agrees; it
/// must not agree to the same face twice. Neighbours across such sides are handed to `across`.
template <class Bars, class Enter, class Across>
void flood(const Faces &faces, std::vector<LocalIndex> &reached, Bars bars, Enter enter, Across across) {
  while (!reached.empty()) {
    const LocalIndex t = reached.back();
    reached.pop_back();
    for (const HalfEdge h : sides_of(t)) {
      const HalfEdge twin = faces.twin(h);
      if (twin == none)
        continue;
      if (bars(h))
        across(face_of(twin));
      else if (enter(face_of(twin)))
        reached.push_back(face_of(twin));
    }
  }
}

/// Where a point lies.
struct Place {
  LocalIndex face;
  bool on_segment; ///< or on an end of one
};

/// Finds faces by walking from the last one found, each time through a side that has the point beyond;
/// through which of two is left to chance, since a fixed choice can go in circles where triangles are not
/// Delaunay (Devillers, Pion, Teillaud, Walking in a triangulation, 2002).
class Walk {
public:
  Walk(std::span<const Point> vertices, const Faces &faces) : vertices_(vertices), faces_(faces) {}

  std::optional<Place> find(Point p) {
    if (faces_.count() == 0)
      return {};
    HalfEdge way = way_out(p);
    while (way != none) {
      if (faces_.twin(way) == none)
        return {};
      at_ = face_of(faces_.twin(way));
      way = way_out(p);
    }
    return Place{at_, touches_segment(p)};
  }

private:
  Point point(LocalIndex v) const { return vertices_[static_cast<std::size_t>(v)]; }
  Sign side(HalfEdge h, Point p) const { return orientation(point(faces_.from(h)), point(faces_.to(h)), p); }

  HalfEdge way_out(Point p) {
    random_ = random_ * 6364136223846793005U + 1442695040888963407U;
    HalfEdge h = 4 * at_ + static_cast<HalfEdge>((random_ >> 33) % 3);
    for (int i = 0; i < 3; ++i, h = next(h))
      if (side(h, p) == Sign::negative)
        return h;
    return none;
  }

  /// p lies in the face, or on its boundary.
  bool touches_segment(Point p) const {
    for (const HalfEdge h : sides_of(at_))
      if (side(h, p) == Sign::zero &&
          (faces_.is_segment(h) || (point(faces_.from(h)) == p && origin_has_segment(h))))
        return true;
    return false;
  }
  /// Whether one of the edges at the origin of h is a segment. Around it clockwise; where the boundary ends
  /// that, its edge is met too, and the others counter-clockwise.
  bool origin_has_segment(HalfEdge h) const {
    HalfEdge at = h;
    do {
      if (faces_.is_segment(at))
        return true;
      const HalfEdge twin = faces_.twin(at);
      if (twin == none)
        break;
      at = next(twin);
    } while (at != h);
    if (faces_.twin(at) != none)
      return false;
    for (at = h; at != none;) {
      at = previous(at);
      if (faces_.is_segment(at))
        return true;
      at = faces_.twin(at);
    }
    return false;
  }

  std::span<const Point> vertices_;
  const Faces &faces_;
  LocalIndex at_ = 0;
  std::uint64_t random_ = 1;
};

constexpr auto nowhere = [](LocalIndex) {};
constexpr auto segments_of(const Faces &faces) {
  return [&faces](HalfEdge h) { return faces.is_segment(h); };
}

} // namespace

void mark_outside(const PlanarGraph &graph, Faces &faces) {
  const bool even_odd = graph.even_odd;
  const auto bars = [&](HalfEdge h) {
    return faces.is_segment(h) && !(even_odd && !graph.is_line.empty() &&
                                    graph.is_line[static_cast<std::size_t>(faces.segment(h))] != 0);
  };
  std::vector<LocalIndex> layer, next_layer; // faces by the number of segments before them
  for (LocalIndex t = 0; t < faces.count(); ++t)
    for (const HalfEdge h : sides_of(t))
      if (faces.twin(h) == none)
        (bars(h) ? next_layer : layer).push_back(t);
  // Marks: 1 outside, 2 inside; what was never reached cannot be.
  bool outside = true;
  while (!layer.empty() || (even_odd && !next_layer.empty())) {
    const std::uint8_t mark = outside ? 1 : 2;
    std::erase_if(
        layer, [&](LocalIndex t) { return faces.face(t).mark != 0 || ((faces.face(t).mark = mark), false); });
    const auto enter = [&](LocalIndex t) {
      return faces.face(t).mark == 0 && (faces.face(t).mark = mark) != 0;
    };
    flood(faces, layer, bars, enter, [&](LocalIndex t) {
      if (faces.face(t).mark == 0)
        next_layer.push_back(t);
    });
    if (!even_odd)
      break;
    layer.swap(next_layer);
    next_layer.clear();
    outside = !outside;
  }
  for (Face &face : faces.faces)
    face.mark = face.mark == 1 ? 1 : 0;
}

std::vector<StraySeed> mark_holes(std::span<const Point> vertices, std::span<const Point> holes,
                                  Faces &faces) {
  std::vector<StraySeed> stray;
  Walk walk(vertices, faces);
  std::vector<LocalIndex> found;
  for (std::size_t i = 0; i < holes.size(); ++i) {
    const auto place = walk.find(holes[i]);
    const auto seed = static_cast<LocalIndex>(i);
    // One hole may have several seeds, but not one where nothing is anyway.
    if (!place || faces.face(place->face).mark != 0)
      stray.push_back({seed, SeedFault::outside});
    else if (place->on_segment)
      stray.push_back({seed, SeedFault::on_segment});
    else
      found.push_back(place->face);
  }
  const auto enter = [&](LocalIndex t) { return faces.face(t).mark == 0 && (faces.face(t).mark = 1) != 0; };
  std::erase_if(found, [&](LocalIndex t) { return !enter(t); });
  flood(faces, found, segments_of(faces), enter, nowhere);
  return stray;
}

std::vector<StraySeed> number_regions(std::span<const Point> vertices, std::span<const RegionSeed> regions,
                                      Faces &faces) {
  std::vector<StraySeed> stray;
  Walk walk(vertices, faces);
  std::vector<LocalIndex> reached;
  for (std::size_t i = 0; i < regions.size(); ++i) {
    const auto seed = static_cast<std::int32_t>(i);
    const auto place = walk.find(regions[i].place);
    if (!place || faces.face(place->face).mark != 0) {
      stray.push_back({seed, SeedFault::outside});
    } else if (place->on_segment) {
      stray.push_back({seed, SeedFault::on_segment});
    } else if (faces.face(place->face).region != none) {
      stray.push_back({seed, SeedFault::taken});
    } else {
      faces.face(place->face).region = seed;
      reached.assign(1, place->face);
      flood(
          faces, reached, segments_of(faces),
          [&](LocalIndex t) {
            if (faces.face(t).region != none || faces.face(t).mark != 0)
              return false;
            faces.face(t).region = seed;
            return true;
          },
          nowhere);
    }
  }
  return stray;
}

} // namespace dovetail
