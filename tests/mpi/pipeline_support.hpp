// What the tests of the pipeline share: points onto ranks, and a distributed mesh looked at as a whole.
#pragma once

#include "dovetail/comm/exchange.hpp"
#include "dovetail/distributed/mesh.hpp"

#include <algorithm>
#include <array>
#include <boost/mpi/communicator.hpp>
#include <map>
#include <optional>
#include <random>
#include <string>
#include <utility>
#include <vector>

namespace dovetail::testing {

inline Communicator world() { return Communicator::duplicate(boost::mpi::communicator()); }

/// This rank's part of points that all ranks know, dealt out at random but alike on all ranks. The attribute
/// "z" is a function of the input index.
inline double z_of(GlobalIndex input_index) { return 0.5 * static_cast<double>(input_index) - 3; }

inline PointTable deal(const Communicator &comm, const std::vector<Point> &points, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_int_distribution<int> rank(0, comm.size() - 1);
  std::vector<GlobalIndex> mine;
  for (std::size_t i = 0; i < points.size(); ++i)
    if (rank(random) == comm.rank())
      mine.push_back(static_cast<GlobalIndex>(i));
  std::shuffle(mine.begin(), mine.end(), random);
  PointTable table;
  table.attributes.push_back({"z", {}});
  for (const GlobalIndex i : mine) {
    table.points.push_back(points[static_cast<std::size_t>(i)]);
    table.input_index.push_back(i);
    table.attributes[0].values.push_back(z_of(i));
  }
  return table;
}

using Corners = std::array<std::pair<double, double>, 3>; ///< of a triangle, ascending

/// A mesh gathered at rank 0.
struct WholeMesh {
  struct Vertex {
    GlobalIndex number, input_index;
    double x, y, z;
    bool ghost;
  };
  struct Triangle {
    std::array<GlobalIndex, 3> corner, neighbour;
  };
  std::vector<Vertex> vertices; ///< slab by slab
  std::vector<Triangle> triangles;
};

inline GlobalIndex vertex_number(const SlabMesh &slab, LocalIndex v) {
  return v < slab.own_count ? slab.first_site + v
                            : slab.ghost_number[static_cast<std::size_t>(v - slab.own_count)];
}

inline WholeMesh gather_mesh(const Communicator &comm, const DistributedMesh &mesh) {
  WholeMesh local;
  for (const SlabMesh &slab : mesh.slabs) {
    for (std::size_t v = 0; v < slab.vertices.points.size(); ++v) {
      const auto vertex = static_cast<LocalIndex>(v);
      local.vertices.push_back({vertex_number(slab, vertex), slab.vertices.input_index.at(v),
                                slab.vertices.points[v].x, slab.vertices.points[v].y,
                                slab.vertices.attributes.at(0).values.at(v), vertex >= slab.own_count});
    }
    std::map<LocalIndex, GlobalIndex> beyond;
    for (const BorderSide &side : slab.border_sides)
      beyond[side.side] = side.neighbour;
    for (LocalIndex t = 0; t < slab.triangles.triangle_count(); ++t) {
      WholeMesh::Triangle triangle{};
      for (LocalIndex i = 0; i < 3; ++i) {
        const auto corner = static_cast<std::size_t>(i), side = 3 * static_cast<std::size_t>(t) + corner;
        triangle.corner[corner] = vertex_number(slab, slab.triangles.corners[side]);
        const LocalIndex inner = slab.triangles.neighbours[side];
        const auto found = beyond.find(3 * t + i);
        triangle.neighbour[corner] = inner != none           ? slab.first_triangle + inner
                                     : found != beyond.end() ? found->second
                                                             : GlobalIndex{none};
      }
      local.triangles.push_back(triangle);
    }
  }
  return {gather_bulk<WholeMesh::Vertex>(comm, local.vertices).data,
          gather_bulk<WholeMesh::Triangle>(comm, local.triangles).data};
}

/// The coordinates of every triangle's corners, ascending. A triangle found twice is there twice.
inline std::vector<Corners> corners_of(const WholeMesh &mesh) {
  std::map<GlobalIndex, std::pair<double, double>> position;
  for (const WholeMesh::Vertex &vertex : mesh.vertices)
    position[vertex.number] = {vertex.x, vertex.y};
  std::vector<Corners> result;
  for (const WholeMesh::Triangle &triangle : mesh.triangles) {
    Corners corners;
    std::ranges::transform(triangle.corner, corners.begin(), [&](GlobalIndex n) { return position.at(n); });
    std::ranges::sort(corners);
    result.push_back(corners);
  }
  std::ranges::sort(result);
  return result;
}

/// The first thing found wrong with numbers, neighbours and ghosts; empty if nothing is.
inline std::string fault_of(const WholeMesh &mesh) {
  const auto size = static_cast<GlobalIndex>(mesh.triangles.size());
  for (GlobalIndex t = 0; t < size; ++t)
    for (std::size_t i = 0; i < 3; ++i) {
      const WholeMesh::Triangle &here = mesh.triangles[static_cast<std::size_t>(t)];
      const GlobalIndex n = here.neighbour[i];
      if (n == none)
        continue;
      if (n < 0 || n >= size)
        return "no such neighbour of triangle " + std::to_string(t);
      const WholeMesh::Triangle &there = mesh.triangles[static_cast<std::size_t>(n)];
      bool found = false;
      for (std::size_t j = 0; j < 3; ++j)
        found = found || (there.neighbour[j] == t && there.corner[(j + 1) % 3] == here.corner[(i + 2) % 3] &&
                          there.corner[(j + 2) % 3] == here.corner[(i + 1) % 3]);
      if (!found)
        return "triangles " + std::to_string(t) + " and " + std::to_string(n) + " disagree";
    }
  std::map<GlobalIndex, WholeMesh::Vertex> owned;
  GlobalIndex next = 0;
  for (const WholeMesh::Vertex &v : mesh.vertices)
    if (!v.ghost) {
      owned[v.number] = v;
      if (v.number != next++)
        return "own sites are not numbered through";
    }
  for (const WholeMesh::Vertex &v : mesh.vertices) {
    const auto owner = owned.find(v.number);
    if (owner == owned.end() || owner->second.x != v.x || owner->second.y != v.y ||
        owner->second.input_index != v.input_index || v.z != z_of(v.input_index))
      return "vertex " + std::to_string(v.number) + " differs from its site";
  }
  return {};
}

} // namespace dovetail::testing
