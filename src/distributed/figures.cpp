#include "dovetail/distributed/figures.hpp"

#include "validation.hpp"

#include "dovetail/comm/agreement.hpp"

#include <cmath>
#include <numbers>

namespace dovetail {
namespace {

using validation::at;
using validation::point_of;
using validation::Side;
using validation::side_of;

/// What every slab adds to the sums.
struct SlabSums {
  double area;
  double edge_length;
  double hull_length;
};

/// How many edges end at a site, as one slab sees it.
struct DegreePart {
  GlobalIndex site;
  GlobalIndex degree;
};

double length_of(const SlabMesh &slab, const Side &side) {
  const Point from = point_of(slab, side.from);
  const Point to = point_of(slab, side.to);
  return std::hypot(to.x - from.x, to.y - from.y);
}

/// Angles and area. Differences are scaled by a power of two, exactly, so that products stay within range.
void measure_triangle(const SlabMesh &slab, LocalIndex triangle, MeshFigures &figures, CompensatedSum &area) {
  std::array<Point, 3> along{}; // the side across from corner i, from corner i + 1 to corner i + 2
  double largest = 0;
  for (LocalIndex i = 0; i < 3; ++i) {
    const Side side = side_of(slab, 3 * triangle + i);
    const Point from = point_of(slab, side.from);
    const Point to = point_of(slab, side.to);
    along[at(i)] = {to.x - from.x, to.y - from.y};
    largest = std::max({largest, std::abs(along[at(i)].x), std::abs(along[at(i)].y)});
  }
  int exponent = 0;
  std::frexp(largest, &exponent);
  for (Point &side : along)
    side = {std::ldexp(side.x, -exponent), std::ldexp(side.y, -exponent)};
  double smallest = 180;
  double doubled = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const Point out = along[(i + 2) % 3]; // leaves corner i
    const Point in = along[(i + 1) % 3];  // arrives at it
    doubled = std::abs(in.x * out.y - in.y * out.x);
    const double cosine = -(in.x * out.x + in.y * out.y);
    const double angle = std::atan2(doubled, cosine) * (180 / std::numbers::pi);
    figures.angles.add(angle);
    smallest = std::min(smallest, angle);
  }
  figures.smallest_angles.add(smallest);
  const double value = std::ldexp(doubled / 2, 2 * exponent);
  figures.areas.add(value);
  area.add(value);
}

/// Edges of a slab: inner ones from the triangle with the lower number, hull edges from their only one.
/// Adds to `degrees`, by vertex, the triangles and, where the hull leaves a site, one more.
void measure_sides(const SlabMesh &slab, MeshFigures &figures, CompensatedSum &all, CompensatedSum &hull,
                   std::vector<GlobalIndex> &degrees) {
  auto border = slab.border_sides.begin();
  const auto sides = static_cast<LocalIndex>(slab.triangles.corners.size());
  for (LocalIndex s = 0; s < sides; ++s) {
    ++degrees[at(slab.triangles.corners[at(s)])];
    const GlobalIndex triangle = slab.first_triangle + s / 3;
    GlobalIndex neighbour = none;
    if (const LocalIndex inside = slab.triangles.neighbours[at(s)]; inside != none)
      neighbour = slab.first_triangle + inside;
    else if (border != slab.border_sides.end() && border->side == s)
      neighbour = (border++)->neighbour;
    if (neighbour != none && neighbour < triangle)
      continue;
    const Side side = side_of(slab, s);
    const double length = length_of(slab, side);
    figures.edge_lengths.add(length);
    all.add(length);
    if (neighbour == none) {
      ++figures.hull_edges;
      hull.add(length);
      ++degrees[at(side.from)];
    }
  }
}

void count_duplicates(const DistributedMesh &mesh, MeshFigures &figures) {
  GlobalIndex run = 0;
  GlobalIndex before = none;
  for (const Duplicate &duplicate : mesh.duplicates) {
    run = duplicate.site == before ? run + 1 : 1;
    figures.repeated_sites += run == 1 ? 1 : 0;
    figures.most_duplicates = std::max(figures.most_duplicates, run);
    before = duplicate.site;
  }
  figures.duplicates = static_cast<GlobalIndex>(mesh.duplicates.size());
}

/// This rank's share of everything, before anything is added up.
struct Share {
  MeshFigures figures;
  std::vector<SlabSums> sums;
  std::vector<std::vector<GlobalIndex>> degrees; ///< of every slab's vertices
  std::vector<DegreePart> of_ghosts;
  std::vector<GlobalIndex> path_sites;
};

Share measure_share(const DistributedMesh &mesh, const Progress &progress) {
  Share share;
  GlobalIndex all_triangles = 0;
  for (const SlabMesh &slab : mesh.slabs)
    all_triangles += slab.triangles.triangle_count();
  GlobalIndex done = 0;
  for (const SlabMesh &slab : mesh.slabs) {
    CompensatedSum area;
    CompensatedSum edges;
    CompensatedSum hull;
    for (LocalIndex t = 0; t < slab.triangles.triangle_count(); ++t) {
      measure_triangle(slab, t, share.figures, area);
      if (++done % 65536 == 0)
        report_progress(progress, "measure", static_cast<double>(done) / static_cast<double>(all_triangles));
    }
    std::vector<GlobalIndex> degrees(slab.vertices.points.size(), 0);
    measure_sides(slab, share.figures, edges, hull, degrees);
    for (std::size_t ghost = 0; ghost < slab.ghost_number.size(); ++ghost)
      share.of_ghosts.push_back({slab.ghost_number[ghost], degrees[at(slab.own_count) + ghost]});
    degrees.resize(at(slab.own_count));
    share.degrees.push_back(std::move(degrees));
    share.sums.push_back({area.value(), edges.value(), hull.value()});
    share.path_sites.push_back(static_cast<GlobalIndex>(slab.left_path.size()));
  }
  count_duplicates(mesh, share.figures);
  return share;
}

/// Collective: what ghosts' slabs saw goes to the sites' owners.
void complete_degrees(const Communicator &comm, const DistributedMesh &mesh, Share &share) {
  std::vector<int> firsts = all_gather(comm, mesh.first_slab);
  firsts.push_back(mesh.slab_count());
  const validation::Ownership owners(mesh, std::move(firsts));
  const auto arrived = validation::deliver(
      comm, share.of_ghosts, [&](const DegreePart &part) { return owners.rank_of_site(part.site); });
  for (const DegreePart &part : arrived) {
    const int slab = owners.slab_of_site(part.site);
    share.degrees[at(slab - mesh.first_slab)][at(part.site - mesh.site_offsets[at(slab)])] += part.degree;
  }
  for (const auto &of_slab : share.degrees)
    for (const GlobalIndex degree : of_slab)
      share.figures.degrees.add(static_cast<double>(degree));
}

/// Collective.
void add_up(const Communicator &comm, Histogram &histogram) {
  histogram.counts = all_reduce_sum(comm, histogram.counts);
  histogram.lowest = all_reduce_min(comm, histogram.lowest);
  histogram.highest = all_reduce_max(comm, histogram.highest);
}

} // namespace

MeshFigures measure(const Communicator &comm, const DistributedMesh &mesh, const Progress &progress) {
  Share share = collectively(comm, [&] { return measure_share(mesh, progress); });
  complete_degrees(comm, mesh, share);
  MeshFigures figures = std::move(share.figures);
  for (Histogram *histogram :
       {&figures.angles, &figures.smallest_angles, &figures.areas, &figures.edge_lengths, &figures.degrees})
    add_up(comm, *histogram);
  for (GlobalIndex *count : {&figures.hull_edges, &figures.duplicates, &figures.repeated_sites})
    *count = all_reduce_sum(comm, *count);
  figures.most_duplicates = all_reduce_max(comm, figures.most_duplicates);

  CompensatedSum area;
  CompensatedSum edges;
  CompensatedSum hull;
  for (const SlabSums &of_slab : all_gather_bulk<SlabSums>(comm, share.sums).data) {
    area.add(of_slab.area);
    edges.add(of_slab.edge_length);
    hull.add(of_slab.hull_length);
  }
  figures.area = area.value();
  figures.edge_length = edges.value();
  figures.hull_length = hull.value();
  figures.path_sites = all_gather_bulk<GlobalIndex>(comm, share.path_sites).data;
  if (!figures.path_sites.empty()) // slab 0 has no left path
    figures.path_sites.erase(figures.path_sites.begin());
  return figures;
}

} // namespace dovetail
