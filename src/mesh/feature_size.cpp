#include "dovetail/mesh/feature_size.hpp"

#include "dovetail/geometry/constructions.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numeric>
#include <queue>
#include <vector>

namespace dovetail {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

template <class Index> constexpr std::size_t index(Index i) { return static_cast<std::size_t>(i); }

struct Box {
  Point low{infinity, infinity}, high{-infinity, -infinity};
  void add(Point p) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y)};
  }
  double squared_distance_from(Point p) const {
    const double x = std::max({low.x - p.x, p.x - high.x, 0.0});
    const double y = std::max({low.y - p.y, p.y - high.y, 0.0});
    return x * x + y * y;
  }
};

/// A segment, or a vertex: then both ends are the same.
struct Feature {
  LocalIndex from;
  LocalIndex to;
  bool touches(const Feature &other) const {
    return from == other.from || from == other.to || to == other.from || to == other.to;
  }
};

double squared_distance_from_segment(Point p, Point a, Point b) {
  const Displacement along = b - a;
  const double length = squared_length(along);
  const double part = length > 0 ? std::clamp(dot(p - a, along) / length, 0.0, 1.0) : 0.0;
  return squared_distance(p, a + part * along);
}

} // namespace

/// A binary tree of boxes: node i has the children 2 i and 2 i + 1, the leaves are single features.
struct FeatureSize::Tree {
  std::vector<Point> vertices;
  std::vector<Feature> features; ///< a power of two of places, the last ones empty
  std::vector<Box> boxes;        ///< from 1 on; those of leaves from leaves on
  std::size_t leaves = 1;

  Point middle(const Feature &f) const {
    return between(vertices[index(f.from)], vertices[index(f.to)], 0.5);
  }

  /// By the median of the longer extent of the middles.
  void order(std::size_t first, std::size_t last) {
    if (last - first < 2)
      return;
    Box box;
    for (std::size_t i = first; i < last; ++i)
      box.add(middle(features[i]));
    const bool by_x = box.high.x - box.low.x >= box.high.y - box.low.y;
    // The left subtree is full but for the last features.
    const std::size_t half = std::bit_ceil(last - first) / 2;
    const auto begin = features.begin() + static_cast<std::ptrdiff_t>(first);
    std::nth_element(begin, begin + static_cast<std::ptrdiff_t>(half),
                     features.begin() + static_cast<std::ptrdiff_t>(last),
                     [&](const Feature &a, const Feature &b) {
                       return by_x ? middle(a).x < middle(b).x : middle(a).y < middle(b).y;
                     });
    order(first, first + half);
    order(first + half, last);
  }

  void build() {
    order(0, features.size());
    leaves = std::bit_ceil(std::max<std::size_t>(1, features.size()));
    boxes.resize(2 * leaves);
    for (std::size_t i = 0; i < features.size(); ++i)
      for (const LocalIndex end : {features[i].from, features[i].to})
        boxes[leaves + i].add(vertices[index(end)]);
    for (std::size_t node = leaves; node-- > 1;)
      for (const std::size_t child : {2 * node, 2 * node + 1})
        if (boxes[child].low.x <= boxes[child].high.x) {
          boxes[node].add(boxes[child].low);
          boxes[node].add(boxes[child].high);
        }
  }
};

FeatureSize::FeatureSize(std::span<const Point> vertices, std::span<const Segment> segments,
                         std::span<const LocalIndex> alone)
    : tree_(std::make_unique<Tree>()) {
  tree_->vertices.assign(vertices.begin(), vertices.end());
  std::vector<LocalIndex> points(alone.begin(), alone.end());
  for (const Segment &segment : segments) {
    tree_->features.push_back({segment.from, segment.to});
    points.insert(points.end(), {segment.from, segment.to});
  }
  std::ranges::sort(points);
  points.erase(std::ranges::unique(points).begin(), points.end());
  for (const LocalIndex v : points)
    tree_->features.push_back({v, v});
  tree_->build();
}

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
  const Tree &tree = *tree_;
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
      if (next.node - tree.leaves < tree.features.size()) {
        const auto [from, to] = tree.features[next.node - tree.leaves];
        queue.push({squared_distance_from_segment(p, tree.vertices[index(from)], tree.vertices[index(to)]),
                    next.node, true});
      }
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
