// Finite elements over a distributed mesh: -laplace(u) = f in the unit square, u = 0 on its boundary, with
// linear elements, solved by conjugate gradients. As f is made for u = sin(pi x) sin(pi y), the error is
// known.
//
// No matrix is ever assembled across ranks: every rank applies those of its own triangles. What that adds to
// ghosts goes to their owners, and what owners know goes to the ghosts.
#include <dovetail/comm/collectives.hpp>
#include <dovetail/distributed/ghosts.hpp>
#include <dovetail/distributed/triangulate.hpp>
#include <dovetail/geometry/distributions.hpp>

#include <boost/mpi/environment.hpp>

#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <utility>
#include <vector>

using dovetail::Communicator, dovetail::Point, dovetail::RankSites;
using Vector = std::vector<double>; ///< a value for each of the rank's sites: own ones, then ghosts

double solution(Point p) { return std::sin(std::numbers::pi * p.x) * std::sin(std::numbers::pi * p.y); }
double load(Point p) { return 2 * std::numbers::pi * std::numbers::pi * solution(p); }
bool on_boundary(Point p) { return p.x == 0 || p.x == 1 || p.y == 0 || p.y == 1; }
Point midpoint(Point a, Point b) { return {(a.x + b.x) / 2, (a.y + b.y) / 2}; }

/// A grid of n x n squares whose inner points have been moved at random; every rank makes some of its rows.
std::vector<Point> shaken_grid(const Communicator &comm, int n) {
  std::vector<Point> points;
  for (int j = comm.rank(); j <= n; j += comm.size())
    for (int i = 0; i <= n; ++i) {
      dovetail::synthetic::Draws draws(1, static_cast<std::uint64_t>(j * (n + 1) + i));
      const bool inside = i > 0 && i < n && j > 0 && j < n;
      const auto shaken = [&](int k) { return (k + (inside ? 0.6 * (draws.unit() - 0.5) : 0.0)) / n; };
      points.push_back({shaken(i), shaken(j)});
    }
  return points;
}

/// A linear triangle: where its corners are among the rank's sites, and the gradients of their hat functions.
struct Element {
  std::array<std::size_t, 3> site;
  std::array<Point, 3> corner, gradient;
  double area;
};

void find_gradients(Element &e) {
  const auto &[a, b, c] = e.corner;
  const double twice = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
  const auto across = [&](Point from, Point to) {
    return Point{(from.y - to.y) / twice, (to.x - from.x) / twice};
  };
  e.gradient = {across(b, c), across(c, a), across(a, b)};
  e.area = twice / 2;
}

/// What one rank knows of the discrete problem.
struct System {
  RankSites sites;
  std::vector<Element> elements;
  std::vector<bool> fixed; ///< the sites on the boundary
};

System discretise(const Communicator &comm, const dovetail::DistributedMesh &mesh) {
  System system{rank_sites(comm, mesh), {}, {}};
  system.fixed.resize(system.sites.size());
  for (const dovetail::SlabMesh &slab : mesh.slabs) {
    const std::vector<std::size_t> position = positions_of_vertices(system.sites, slab);
    for (std::size_t v = 0; v < position.size(); ++v)
      system.fixed[position[v]] = on_boundary(slab.vertices.points[v]);
    for (std::size_t t = 0; t < slab.triangles.corners.size(); t += 3) {
      Element &e = system.elements.emplace_back();
      for (std::size_t i = 0; i < 3; ++i) {
        const auto v = static_cast<std::size_t>(slab.triangles.corners[t + i]);
        e.site[i] = position[v];
        e.corner[i] = slab.vertices.points[v];
      }
      find_gradients(e);
    }
  }
  return system;
}

/// Adds up what the triangles of all ranks gave to each site; ghosts are brought up to date, too.
void assemble(const Communicator &comm, const System &system, Vector &values) {
  dovetail::add_ghosts<double>(comm, system.sites, values);
  dovetail::update_ghosts<double>(comm, system.sites, values);
  for (std::size_t s = 0; s < values.size(); ++s)
    if (system.fixed[s])
      values[s] = 0;
}

/// The integrals of load times each hat function, by the rule of the edges' midpoints.
Vector right_side(const Communicator &comm, const System &system) {
  Vector values(system.sites.size());
  for (const Element &e : system.elements)
    for (std::size_t i = 0; i < 3; ++i)
      for (const std::size_t j : {(i + 1) % 3, (i + 2) % 3})
        values[e.site[i]] += e.area / 6 * load(midpoint(e.corner[i], e.corner[j]));
  assemble(comm, system, values);
  return values;
}

Vector times_stiffness(const Communicator &comm, const System &system, const Vector &u) {
  Vector values(u.size());
  for (const Element &e : system.elements) {
    Point gradient{0, 0};
    for (std::size_t i = 0; i < 3; ++i)
      gradient = {gradient.x + u[e.site[i]] * e.gradient[i].x, gradient.y + u[e.site[i]] * e.gradient[i].y};
    for (std::size_t i = 0; i < 3; ++i)
      values[e.site[i]] += e.area * (gradient.x * e.gradient[i].x + gradient.y * e.gradient[i].y);
  }
  assemble(comm, system, values);
  return values;
}

/// Every site counts once, with its owner.
double dot(const Communicator &comm, const System &system, const Vector &a, const Vector &b) {
  double sum = 0;
  for (std::size_t s = 0; s < system.sites.own_count; ++s)
    sum += a[s] * b[s];
  return all_reduce_sum(comm, sum);
}

Vector conjugate_gradients(const Communicator &comm, const System &system, Vector residual) {
  Vector u(residual.size()), direction = residual;
  double square = dot(comm, system, residual, residual);
  const double enough = 1e-24 * square;
  while (square > enough) {
    const Vector image = times_stiffness(comm, system, direction);
    const double step = square / dot(comm, system, direction, image);
    for (std::size_t s = 0; s < u.size(); ++s) {
      u[s] += step * direction[s];
      residual[s] -= step * image[s];
    }
    const double last = std::exchange(square, dot(comm, system, residual, residual));
    for (std::size_t s = 0; s < u.size(); ++s)
      direction[s] = residual[s] + square / last * direction[s];
  }
  return u;
}

/// The norm of u - solution in L2.
double error_of(const Communicator &comm, const System &system, const Vector &u) {
  double square = 0;
  for (const Element &e : system.elements)
    for (std::size_t i = 0; i < 3; ++i) {
      const std::size_t j = (i + 1) % 3;
      const double there = (u[e.site[i]] + u[e.site[j]]) / 2 - solution(midpoint(e.corner[i], e.corner[j]));
      square += e.area / 3 * there * there;
    }
  return std::sqrt(all_reduce_sum(comm, square));
}

int main(int argc, char **argv) {
  const boost::mpi::environment environment(argc, argv);
  const auto comm = Communicator::duplicate(MPI_COMM_WORLD);
  double coarser = 0;
  for (const int n : {8, 16, 32, 64}) {
    const System system = discretise(comm, dovetail::triangulate(comm, shaken_grid(comm, n)));
    const double error = error_of(comm, system, conjugate_gradients(comm, system, right_side(comm, system)));
    if (comm.is_root())
      std::printf("n = %2d: error %.10e, order %.2f\n", n, error,
                  coarser > 0 ? std::log2(coarser / error) : 0);
    coarser = error;
  }
}
