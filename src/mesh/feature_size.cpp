#include "dovetail/mesh/feature_size.hpp"

#include "dovetail/geometry/constructions.hpp"
#include "feature_tree.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
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
  std::vector<Feature> seen;
  while (!queue.empty()) {
    const Candidate next = queue.top();
    queue.pop();
    if (next.is_exact) {
      const Feature &feature = tree.features[next.node - tree.leaves];
      if (std::ranges::any_of(seen, [&](const Feature &other) { return !feature.touches(other); }))
        return std::sqrt(next.distance);
      seen.push_back(feature);
    } else if (next.node >= tree.leaves) {
      if (const std::size_t feature = next.node - tree.leaves; feature < tree.features.size())
        queue.push({tree.squared_distance(p, feature), next.node, true});
    } else {
      for (const std::size_t child : {2 * next.node, 2 * next.node + 1})
        if (const double distance = tree.boxes[child].squared_distance_from(p); distance < infinity)
          queue.push({distance, child, false});
    }
  }
  return infinity;
}

namespace {

constexpr int deepest = 12;     // divisions in four
constexpr double change = 0.03; // of a triangle's part; what is left of the error then is a fraction of it

/// 1 / lfs^2 at the middles of three sides, times a third of the area: exact for quadratic functions.
class Quadrature {
public:
  explicit Quadrature(const FeatureSize &size) : size_(size) {}

  double integrate(Point a, Point b, Point c) const { return refined(a, b, c, rule(a, b, c), 0); }

private:
  double density(Point p) const {
    const double size = size_.at(p);
    return 1 / (size * size);
  }
  double rule(Point a, Point b, Point c) const {
    return std::fabs(doubled_area(a, b, c)) / 6 *
           (density(between(a, b, 0.5)) + density(between(b, c, 0.5)) + density(between(c, a, 0.5)));
  }
  double refined(Point a, Point b, Point c, double whole, int depth) const {
    const Point ab = between(a, b, 0.5), bc = between(b, c, 0.5), ca = between(c, a, 0.5);
    const double parts[4] = {rule(a, ab, ca), rule(ab, b, bc), rule(ca, bc, c), rule(ab, bc, ca)};
    const double sum = parts[0] + parts[1] + parts[2] + parts[3];
    if (!(std::fabs(sum - whole) > change * sum) || depth >= deepest)
      return sum;
    return refined(a, ab, ca, parts[0], depth + 1) + refined(ab, b, bc, parts[1], depth + 1) +
           refined(ca, bc, c, parts[2], depth + 1) + refined(ab, bc, ca, parts[3], depth + 1);
  }

  const FeatureSize &size_;
};

} // namespace

double integrate_feature_density(const DomainMesh &mesh, const FeatureSize &size, const Progress &progress) {
  const Quadrature quadrature(size);
  const std::vector<LocalIndex> &corners = mesh.triangles.corners;
  constexpr std::size_t at_once = 3 * 1024;
  double sum = 0;
  for (std::size_t side = 0; side < corners.size(); side += 3) {
    const auto corner = [&](std::size_t i) { return mesh.vertices[index(corners[side + i])]; };
    sum += quadrature.integrate(corner(0), corner(1), corner(2));
    if (side % at_once == 0)
      report_progress(progress, "measure", static_cast<double>(side) / static_cast<double>(corners.size()));
  }
  return sum;
}

} // namespace dovetail
