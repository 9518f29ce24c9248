// Finite elements on a domain that Dovetail meshes: -laplace(u) = f in an L-shaped room with a square pillar,
// u given on all walls, with linear elements and Eigen's sparse Cholesky factorisation. As f is made for
// u = sin(x) exp(y), the error is known, and it falls at second order in the mesh size.
//
// One process, no MPI: segments, constrained triangulation, refinement, assembly.
#include <dovetail/mesh/constrain.hpp>
#include <dovetail/mesh/planarise.hpp>
#include <dovetail/mesh/refine.hpp>

#include <Eigen/SparseCholesky>

#include <array>
#include <cmath>
#include <cstdio>
#include <vector>

using dovetail::DomainMesh, dovetail::LocalIndex, dovetail::Point;

double solution(Point p) { return std::sin(2 * p.x) * std::exp(p.y); }
double load(Point p) { return 3 * solution(p); } // -laplace of it: (4 - 1) u

/// Walls have marker 1, the pillar has marker 2, and a seed says that nothing is inside of it.
dovetail::SegmentSet room() {
  dovetail::SegmentSet set;
  const auto add_outline = [&](const std::vector<Point> &corners, std::int32_t marker) {
    const auto first = static_cast<LocalIndex>(set.vertices.size());
    const auto count = static_cast<LocalIndex>(corners.size());
    set.vertices.insert(set.vertices.end(), corners.begin(), corners.end());
    for (LocalIndex i = 0; i < count; ++i)
      set.segments.push_back({first + i, first + (i + 1) % count, marker});
  };
  add_outline({{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}}, 1);
  add_outline({{0.3, 0.3}, {0.6, 0.3}, {0.6, 0.6}, {0.3, 0.6}}, 2);
  set.holes.push_back({0.45, 0.45});
  return set;
}

DomainMesh mesh_of_room(double max_area) {
  const dovetail::Planarised planar = dovetail::planarise(room());
  dovetail::Constrained constrained = dovetail::constrain(planar.graph);
  dovetail::RefineOptions options;
  options.min_angle = 28;
  options.max_area = max_area;
  return dovetail::refine(std::move(constrained.mesh), planar.graph.segments, options).mesh;
}

/// Corners of a triangle, and the gradients of their hat functions.
struct Element {
  std::array<LocalIndex, 3> vertex;
  std::array<Point, 3> corner, gradient;
  double area;
};

Element element_of(const DomainMesh &mesh, std::size_t t) {
  Element e{};
  for (std::size_t i = 0; i < 3; ++i) {
    e.vertex[i] = mesh.triangles.corners[3 * t + i];
    e.corner[i] = mesh.vertices[static_cast<std::size_t>(e.vertex[i])];
  }
  const auto &[a, b, c] = e.corner;
  const double twice = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
  const auto across = [&](Point from, Point to) {
    return Point{(from.y - to.y) / twice, (to.x - from.x) / twice};
  };
  e.gradient = {across(b, c), across(c, a), across(a, b)};
  e.area = twice / 2;
  return e;
}

/// Walls are where a side has no neighbour.
std::vector<bool> vertices_on_walls(const DomainMesh &mesh) {
  std::vector<bool> on_wall(mesh.vertices.size(), false);
  for (std::size_t side = 0; side < mesh.triangles.corners.size(); ++side)
    if (mesh.triangles.neighbours[side] == dovetail::none)
      for (const std::size_t corner : {(side + 1) % 3, (side + 2) % 3})
        on_wall[static_cast<std::size_t>(mesh.triangles.corners[side - side % 3 + corner])] = true;
  return on_wall;
}

/// Values at the vertices.
Eigen::VectorXd solve(const DomainMesh &mesh) {
  const auto count = static_cast<Eigen::Index>(mesh.vertices.size());
  const std::vector<bool> on_wall = vertices_on_walls(mesh);
  Eigen::VectorXd values = Eigen::VectorXd::Zero(count), right = Eigen::VectorXd::Zero(count);
  std::vector<Eigen::Triplet<double>> entries;
  for (Eigen::Index v = 0; v < count; ++v)
    if (on_wall[static_cast<std::size_t>(v)]) {
      values[v] = solution(mesh.vertices[static_cast<std::size_t>(v)]);
      entries.emplace_back(v, v, 1.0);
      right[v] = values[v];
    }
  for (std::size_t t = 0; 3 * t < mesh.triangles.corners.size(); ++t) {
    const Element e = element_of(mesh, t);
    for (std::size_t i = 0; i < 3; ++i) {
      if (on_wall[static_cast<std::size_t>(e.vertex[i])])
        continue;
      for (const std::size_t k : {(i + 1) % 3, (i + 2) % 3}) // the two middles of sides at this corner
        right[e.vertex[i]] +=
            e.area / 6 * load({(e.corner[i].x + e.corner[k].x) / 2, (e.corner[i].y + e.corner[k].y) / 2});
      for (std::size_t j = 0; j < 3; ++j) {
        const double entry = e.area * (e.gradient[i].x * e.gradient[j].x + e.gradient[i].y * e.gradient[j].y);
        if (on_wall[static_cast<std::size_t>(e.vertex[j])])
          right[e.vertex[i]] -= entry * values[e.vertex[j]]; // known, so it goes to the right
        else
          entries.emplace_back(e.vertex[i], e.vertex[j], entry);
      }
    }
  }
  Eigen::SparseMatrix<double> matrix(count, count);
  matrix.setFromTriplets(entries.begin(), entries.end());
  return Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>>(matrix).solve(right);
}

/// In the mean square over the domain, from the middles of sides.
double error_of(const DomainMesh &mesh, const Eigen::VectorXd &values) {
  double sum = 0;
  for (std::size_t t = 0; 3 * t < mesh.triangles.corners.size(); ++t) {
    const Element e = element_of(mesh, t);
    for (std::size_t i = 0; i < 3; ++i) {
      const std::size_t k = (i + 1) % 3;
      const double found = (values[e.vertex[i]] + values[e.vertex[k]]) / 2;
      const double wrong =
          found - solution({(e.corner[i].x + e.corner[k].x) / 2, (e.corner[i].y + e.corner[k].y) / 2});
      sum += e.area / 3 * wrong * wrong;
    }
  }
  return std::sqrt(sum);
}

int main() {
  for (double max_area = 0.01; max_area > 1e-4; max_area /= 4) {
    const DomainMesh mesh = mesh_of_room(max_area);
    std::printf("%d triangles, none larger than %g: error %.4e\n", mesh.triangles.triangle_count(), max_area,
                error_of(mesh, solve(mesh)));
  }
}
