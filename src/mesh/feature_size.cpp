#include "dovetail/mesh/feature_size.hpp"

#include "dovetail/geometry/constructions.hpp"
#include "feature_tree.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <queue>
#include <vector>

namespace dovetail {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

template <class Index> constexpr std::size_t index(Index i) { return static_cast<std::size_t>(i); }

std::vector<Feature> features_of(std::span<const Segment> segments, std::span<const LocalIndex> alone) {
  std::vector<Feature> features;
  std::vector<LocalIndex> points(alone.begin(), alone.end());
  for (const Segment &segment : segments) {
    features.push_back({segment.from, segment.to});
    points.insert(points.end(), {segment.from, segment.to});
  }
  std::ranges::sort(points);
  points.erase(std::ranges::unique(points).begin(), points.end());
  for (const LocalIndex v : points)
    features.push_back({v, v});
  return features;
}

} // namespace

FeatureSize::FeatureSize(std::span<const Point> vertices, std::span<const Segment> segments,
                         std::span<const LocalIndex> alone)
    : tree_(std::make_unique<FeatureTree>(vertices, features_of(segments, alone))) {}

FeatureSize::~FeatureSize() = default;
FeatureSize::FeatureSize(FeatureSize &&) noexcept = default;

namespace {

/// Features that touch each other, as many as decide of the next one whether it touches all.
class Touching {
public:
  /// False, and nothing more, if the feature does not touch one of those before.
  bool add(const Feature &feature) {
    if (!has_common(feature) && std::any_of(kept_.begin(), kept_.begin() + count_,
                                            [&](const Feature &other) { return !feature.touches(other); }))
      return false;
    if (std::find(kept_.begin(), kept_.begin() + count_, feature) != kept_.begin() + count_)
      return true; // another part of it
    // No other feature touches all of three that have one end in common, or are the sides of a triangle; so
    // more of them tell nothing.
    if (count_ < kept_.size()) {
      common_ = count_ == 0 ? feature : common_ends(common_, feature);
      kept_[count_++] = feature;
    }
    return true;
  }
  /// Whether features with these ends cannot but touch all, however many.
  bool is_full_and_has(const Feature &ends) const { return count_ == kept_.size() && has_common(ends); }

private:
  bool has_common(const Feature &f) const {
    return (common_.from != none && f.has(common_.from)) || (common_.to != none && f.has(common_.to));
  }

  std::array<Feature, 3> kept_;
  std::size_t count_ = 0;
  Feature common_{none, none};
};

} // namespace

/// Features come by distance; the first one that does not touch one of those before it decides.
double FeatureSize::at(Point p) const {
  struct Candidate {
    double distance;
    std::size_t node;
    bool is_exact; ///< the distance of the feature, not of its box
    bool operator>(const Candidate &other) const { return distance > other.distance; }
  };
  const FeatureTree &tree = *tree_;
  std::priority_queue<Candidate, std::vector<Candidate>, std::greater<>> queue;
  queue.push({0, 1, false});
  Touching seen;
  while (!queue.empty()) {
    const Candidate next = queue.top();
    queue.pop();
    if (seen.is_full_and_has(tree.common[next.node]))
      continue;
    if (next.is_exact) {
      if (!seen.add(tree.parts[next.node - tree.leaves].feature))
        return std::sqrt(next.distance);
    } else if (next.node >= tree.leaves) {
      if (const std::size_t i = next.node - tree.leaves; i < tree.parts.size())
        queue.push({tree.parts[i].squared_distance(p), next.node, true});
    } else {
      for (const std::size_t child : {2 * next.node, 2 * next.node + 1})
        if (const double distance = tree.boxes[child].squared_distance_from(p); distance < infinity)
          queue.push({distance, child, false});
    }
  }
  return infinity;
}

namespace {

/// What taking quarters for all pieces changes, of the whole; what is left of the error then is a fraction of
/// it.
constexpr double change = 0.05;
/// More are needed only where doubles do not resolve the features, or needles are all there is.
constexpr std::size_t fewest_halvings = 10'000, halvings_a_triangle = 20;

/// A triangle and its part of the integral, by its quarters, and how far that is from its part without them.
struct Piece {
  Point a, b, c; ///< ab is the longest side
  double part;
  double change;
  bool operator<(const Piece &other) const { return change < other.change; }
};

/// 1 / lfs^2 at the middles of three sides, times a third of the area: exact for quadratic functions.
class Quadrature {
public:
  explicit Quadrature(const FeatureSize &size) : size_(size) {}

  Piece piece(Point a, Point b, Point c) const {
    const Point ab = between(a, b, 0.5), bc = between(b, c, 0.5), ca = between(c, a, 0.5);
    const double part = rule(a, ab, ca) + rule(ab, b, bc) + rule(ca, bc, c) + rule(ab, bc, ca);
    const double difference = std::fabs(part - rule(a, b, c));
    const double side_ab = squared_distance(a, b), side_bc = squared_distance(b, c),
                 side_ca = squared_distance(c, a);
    if (side_bc > side_ab && side_bc >= side_ca)
      return {b, c, a, part, difference};
    return side_ca > side_ab ? Piece{c, a, b, part, difference} : Piece{a, b, c, part, difference};
  }

private:
  double density(Point p) const {
    const double size = size_.at(p);
    return 1 / (size * size);
  }

  double rule(Point a, Point b, Point c) const {
    return std::fabs(doubled_area(a, b, c)) / 6 *
           (density(between(a, b, 0.5)) + density(between(b, c, 0.5)) + density(between(c, a, 0.5)));
  }

  const FeatureSize &size_;
};

} // namespace

/// What changes most is divided first, wherever it is; in halves, since needles are long in one direction
/// only.
std::optional<double> integrate_feature_density(const DomainMesh &mesh, const FeatureSize &size,
                                                const Progress &progress) {
  const Quadrature quadrature(size);
  const std::vector<LocalIndex> &corners = mesh.triangles.corners;
  constexpr std::size_t at_once = 3 * 1024;
  std::priority_queue<Piece> pieces;
  double sum = 0, changes = 0;
  const auto add = [&](const Piece &piece) {
    sum += piece.part;
    changes += piece.change;
    pieces.push(piece);
  };
  for (std::size_t side = 0; side < corners.size(); side += 3) {
    const auto corner = [&](std::size_t i) { return mesh.vertices[index(corners[side + i])]; };
    add(quadrature.piece(corner(0), corner(1), corner(2)));
    if (side % at_once == 0)
      report_progress(progress, "measure", static_cast<double>(side) / static_cast<double>(corners.size()));
  }
  const std::size_t most = fewest_halvings + halvings_a_triangle * pieces.size();
  for (std::size_t halvings = 0; changes > change * sum; ++halvings) {
    if (halvings == most)
      return {};
    const Piece worst = pieces.top();
    pieces.pop();
    sum -= worst.part;
    changes -= worst.change;
    const Point middle = between(worst.a, worst.b, 0.5);
    add(quadrature.piece(worst.a, middle, worst.c));
    add(quadrature.piece(middle, worst.b, worst.c));
  }
  return std::isfinite(sum) ? std::optional(sum) : std::nullopt;
}

} // namespace dovetail
