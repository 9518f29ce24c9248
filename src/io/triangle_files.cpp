// The files of Triangle (Shewchuk, "Triangle: Engineering a 2D Quality Mesh Generator and Delaunay
// Triangulator", 1996, and its pages on the formats): NAME.node, NAME.ele and NAME.neigh, numbered from zero.
//
// The .node file repeats the points of the input in their order, merged duplicates as well, so that the
// numbers in the .ele file are the user's own. Sites are held by slab: blocks of nodes go round the ranks,
// and for each round the points of its blocks are brought together, made into text and written. So no rank
// ever holds more than one block of others' points, and the text, made once, need not be kept.
#include "mesh_formats.hpp"
#include "mesh_rows.hpp"
#include "node_numbers.hpp"
#include "points_write_text.hpp"
#include "text_output.hpp"

#include "dovetail/comm/agreement.hpp"
#include "dovetail/comm/collectives.hpp"
#include "dovetail/comm/exchange.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <numeric>

namespace dovetail {
namespace {

constexpr std::int64_t usual_line_bytes = 64;

/// This rank's points, sites and then duplicates, in the order in which their blocks are written.
class PointsByBlock {
public:
  /// Throws Error (input) about `path` if a duplicate is none of a site of this rank.
  PointsByBlock(const DistributedMesh &mesh, const NodeNumbers &numbers, GlobalIndex block_nodes,
                const std::string &path);

  GlobalIndex node_count() const { return numbers_.count(); }
  /// The first node of a block, or the end.
  GlobalIndex first_of_block(std::int64_t block) const {
    return std::min(node_count(), block * block_nodes_);
  }
  /// Points of block b are those from places()[b] to places()[b + 1].
  const std::vector<std::int64_t> &places() const { return places_; }
  GlobalIndex number(std::int64_t place) const { return number_of(order_[at(place)]); }
  Point point(std::int64_t place) const {
    const Where where = find(order_[at(place)]);
    return mesh_.slabs[where.slab].vertices.points[where.vertex];
  }
  /// A duplicate has a z of its own; all else is its site's.
  double attribute(std::int64_t place, std::size_t a) const {
    const std::int64_t id = order_[at(place)];
    const Where where = find(id);
    const Attribute &attribute = mesh_.slabs[where.slab].vertices.attributes[a];
    if (id >= sites_ && attribute.name == "z")
      return mesh_.duplicates[at(id - sites_)].z;
    return attribute.values[where.vertex];
  }

private:
  struct Where {
    std::size_t slab;
    std::size_t vertex;
  };
  /// Of the site itself, or of a duplicate's.
  Where find(std::int64_t id) const {
    const GlobalIndex site = id < sites_ ? first_sites_.front() + id : mesh_.duplicates[at(id - sites_)].site;
    // The last slab that begins at or before the site: those without sites begin where the next one does.
    const auto beyond = std::upper_bound(first_sites_.begin(), first_sites_.end() - 1, site);
    const auto slab = at(beyond - first_sites_.begin()) - 1;
    return {slab, at(site - first_sites_[slab])};
  }
  GlobalIndex number_of(std::int64_t id) const {
    if (id >= sites_)
      return numbers_.of_duplicate(at(id - sites_));
    const Where where = find(id);
    return numbers_.of_vertex(where.slab, static_cast<LocalIndex>(where.vertex));
  }

  const DistributedMesh &mesh_;
  const NodeNumbers &numbers_;
  const GlobalIndex block_nodes_;
  std::int64_t sites_ = 0;
  std::vector<GlobalIndex> first_sites_; ///< of this rank's slabs, and the end
  std::vector<std::int64_t> order_, places_;
};

PointsByBlock::PointsByBlock(const DistributedMesh &mesh, const NodeNumbers &numbers, GlobalIndex block_nodes,
                             const std::string &path)
    : mesh_(mesh), numbers_(numbers), block_nodes_(block_nodes) {
  for (const SlabMesh &slab : mesh.slabs)
    first_sites_.push_back(slab.first_site);
  if (!mesh.slabs.empty()) {
    first_sites_.push_back(mesh.slabs.back().first_site + mesh.slabs.back().own_count);
    sites_ = first_sites_.back() - first_sites_.front();
  }
  const auto points = sites_ + static_cast<std::int64_t>(mesh.duplicates.size());
  for (const Duplicate &duplicate : mesh.duplicates)
    if (first_sites_.empty() || duplicate.site < first_sites_.front() ||
        duplicate.site >= first_sites_.back())
      throw Error({ErrorKind::input, path, "",
                   fmt::format("input index {} is a duplicate of no site of its slab", duplicate.input_index),
                   "check the mesh with dovetail verify, and make it again"});
  places_.assign(at(numbers.count() / block_nodes + 2), 0);
  for (std::int64_t id = 0; id < points; ++id)
    ++places_[at(number_of(id) / block_nodes + 1)];
  std::partial_sum(places_.begin(), places_.end(), places_.begin());
  std::vector<std::int64_t> next = places_;
  order_.resize(at(points));
  for (std::int64_t id = 0; id < points; ++id)
    order_[at(next[at(number_of(id) / block_nodes)]++)] = id;
}

/// Brings the points of a round to the ranks that write their blocks: block `first_block` + r to rank r.
class Round {
public:
  /// Collective.
  Round(const Communicator &comm, const PointsByBlock &points, std::int64_t first_block)
      : comm_(comm), send_counts_(at(comm.size()), 0) {
    const auto end = static_cast<std::int64_t>(points.places().size()) - 1;
    first_place_ = points.places()[at(std::min(end, first_block))];
    for (int r = 0; r < comm.size(); ++r)
      send_counts_[at(r)] = points.places()[at(std::min(end, first_block + r + 1))] -
                            points.places()[at(std::min(end, first_block + r))];
    receive_counts_ = exchange_counts(comm, send_counts_);
  }
  GlobalIndex received() const {
    return std::accumulate(receive_counts_.begin(), receive_counts_.end(), GlobalIndex{0});
  }
  /// Collective: value_of(place) of every point, as they come.
  template <class T, class ValueOf> std::vector<T> bring(ValueOf &&value_of) const {
    std::vector<T> sent(at(std::accumulate(send_counts_.begin(), send_counts_.end(), std::int64_t{0})));
    for (std::size_t i = 0; i < sent.size(); ++i)
      sent[i] = value_of(first_place_ + static_cast<std::int64_t>(i));
    std::vector<T> arrived(at(received()));
    exchange_into<T>(comm_, sent, send_counts_, arrived, receive_counts_);
    return arrived;
  }

private:
  const Communicator &comm_;
  std::vector<std::int64_t> send_counts_, receive_counts_;
  std::int64_t first_place_ = 0;
};

/// Local. Where each of the points that came belongs, counted from `first`; every node of the block comes
/// once.
std::vector<std::size_t> places_in_block(const std::vector<GlobalIndex> &numbers, GlobalIndex first,
                                         GlobalIndex count, const std::string &path) {
  std::vector<std::size_t> places;
  std::vector<bool> seen(at(count), false);
  for (const GlobalIndex number : numbers) {
    const auto place = at(number - first);
    if (place >= seen.size() || seen[place])
      throw Error({ErrorKind::input, path, "", fmt::format("two points have the input index {}", number),
                   "check the mesh with dovetail verify, and make it again"});
    seen[place] = true;
    places.push_back(place);
  }
  return places;
}

/// Collective. This rank's block of a round, in the order of nodes.
PointTable make_block(const Communicator &comm, const PointsByBlock &points, std::int64_t first_block,
                      const std::vector<std::string> &names, const std::string &path) {
  const Round round(comm, points, first_block);
  const GlobalIndex first = points.first_of_block(first_block + comm.rank());
  const GlobalIndex count = points.first_of_block(first_block + comm.rank() + 1) - first;
  const auto numbers = round.bring<GlobalIndex>([&](auto place) { return points.number(place); });
  const auto places = collectively(comm, [&] { return places_in_block(numbers, first, count, path); });
  const auto in_order = [&]<class T>(const std::vector<T> &arrived) {
    std::vector<T> ordered(at(count));
    for (std::size_t i = 0; i < places.size(); ++i)
      ordered[places[i]] = arrived[i];
    return ordered;
  };
  PointTable block;
  block.points = in_order(round.bring<Point>([&](auto place) { return points.point(place); }));
  for (std::size_t a = 0; a < names.size(); ++a)
    block.attributes.push_back(
        {names[a], in_order(round.bring<double>([&](auto place) { return points.attribute(place, a); }))});
  return block;
}

/// Collective. Which attribute is the boundary marker, as in write_points; past the end if none is.
std::size_t find_marker(const Communicator &comm, const DistributedMesh &mesh,
                        const std::vector<std::string> &names) {
  const auto found = at(std::find(names.begin(), names.end(), "marker") - names.begin());
  if (found == names.size())
    return found;
  const bool whole = std::all_of(mesh.slabs.begin(), mesh.slabs.end(), [&](const SlabMesh &slab) {
    return are_whole(slab.vertices.attributes[found].values);
  });
  return all_of_ranks(comm, whole) ? found : names.size();
}

/// Collective.
void write_nodes(const Communicator &comm, const DistributedMesh &mesh, const NodeNumbers &numbers,
                 const MeshWriting &writing, OutputFile &file) {
  const std::vector<std::string> names = gather_attribute_names(comm, mesh);
  const std::size_t marker = find_marker(comm, mesh, names);
  const bool has_marker = marker < names.size();
  const std::string head =
      fmt::format("{} 2 {} {}\n", numbers.count(), names.size() - (has_marker ? 1 : 0), has_marker ? 1 : 0);
  const GlobalIndex block_nodes = std::max<GlobalIndex>(1, writing.buffer_bytes / usual_line_bytes);
  const PointsByBlock points = collectively(comm, [&] {
    write_text_at(comm, file, 0, head);
    return PointsByBlock(mesh, numbers, block_nodes, file.path());
  });
  auto end = static_cast<std::int64_t>(head.size());
  ProgressCount count(writing.progress, "write", static_cast<double>(points.node_count()));
  for (std::int64_t block = 0; points.first_of_block(block) < points.node_count(); block += comm.size()) {
    const PointTable own = make_block(comm, points, block, names, file.path());
    TextStyle style;
    style.numbered = true;
    style.first_number = points.first_of_block(block + comm.rank());
    for (std::size_t a = 0; a < names.size(); ++a)
      if (a != marker)
        style.attributes.push_back(&own.attributes[a].values);
    if (has_marker)
      style.marker = &own.attributes[marker].values;
    std::string text;
    collectively(comm, [&] { append_lines(own, 0, own.points.size(), style, text); });
    const auto bytes = static_cast<std::int64_t>(text.size());
    const std::int64_t offset = end + exclusive_scan(comm, bytes);
    collectively(comm, [&] {
      file.write_at(offset, std::as_bytes(std::span(text)));
      count.add(
          static_cast<double>(points.first_of_block(block + comm.size()) - points.first_of_block(block)));
    });
    end += all_reduce_sum(comm, bytes);
  }
}

/// Collective. Lines "triangle a b c" of all triangles, a, b, c being value(slab of this rank, side).
template <class MakeValue>
void write_triples(const Communicator &comm, const DistributedMesh &mesh, OutputFile &file,
                   const std::string &head, const MeshWriting &writing, MakeValue &&make_value) {
  collectively(comm, [&] { write_text_at(comm, file, 0, head); });
  write_lines(comm, file, static_cast<std::int64_t>(head.size()), writing.buffer_bytes, writing.progress,
              [&](auto &sink) {
                for (std::size_t k = 0; k < mesh.slabs.size(); ++k) {
                  const SlabMesh &slab = mesh.slabs[k];
                  auto value = make_value(k);
                  const GlobalIndex triangles = slab.triangles.triangle_count();
                  for (GlobalIndex t = 0; t < triangles; ++t) {
                    sink.add(slab.first_triangle + t);
                    for (GlobalIndex side = 3 * t; side < 3 * t + 3; ++side) {
                      sink.add(' ');
                      sink.add(value(side));
                    }
                    sink.end_line();
                  }
                }
              });
}

/// Local: NAME.poly of the mesh of a domain, whose vertices are in NAME.node.
std::string poly_text(const DistributedMesh &mesh, const NodeNumbers &numbers) {
  const DomainRecord &domain = record_of(mesh);
  const Triangulation &triangles = mesh.slabs.front().triangles;
  std::string lines;
  std::size_t count = 0;
  for (std::size_t side = 0; side < domain.segment_of_side.size(); ++side) {
    const LocalIndex segment = domain.segment_of_side[side];
    const LocalIndex beyond = triangles.neighbours[side];
    if (segment < 0 || at(segment) >= domain.segments.size() || (beyond >= 0 && at(beyond) < side / 3))
      continue;
    const std::size_t base = side - side % 3;
    lines += fmt::format(
        "{} {} {} {}\n", count++, numbers.of_vertex(0, triangles.corners[base + (side + 1) % 3]),
        numbers.of_vertex(0, triangles.corners[base + (side + 2) % 3]), domain.segments[at(segment)].marker);
  }
  std::string text = fmt::format("0 2 0 1\n{} 1\n{}{}\n", count, lines, domain.holes.size());
  for (std::size_t i = 0; i < domain.holes.size(); ++i)
    text += fmt::format("{} {} {}\n", i, domain.holes[i].x, domain.holes[i].y);
  text += fmt::format("{}\n", domain.regions.size());
  for (std::size_t i = 0; i < domain.regions.size(); ++i) {
    const RegionSeed &region = domain.regions[i];
    text +=
        fmt::format("{} {} {} {} {}\n", i, region.place.x, region.place.y, region.attribute, region.max_area);
  }
  return text;
}

} // namespace

std::vector<std::string> triangle_files(const std::string &path) {
  const std::string base = without_extension(path);
  std::vector<std::string> files;
  for (const char *extension : {".node", ".neigh", ".ele"})
    files.push_back(base + extension);
  return files;
}

std::vector<std::string> write_triangle_files(const Communicator &comm, const DistributedMesh &mesh,
                                              const std::string &path, const MeshWriting &writing) {
  std::vector<std::string> names = triangle_files(path);
  std::vector<std::unique_ptr<OutputFile>> parts;
  for (const std::string &name : {names[0], names[1]})
    parts.push_back(std::make_unique<OutputFile>(comm, name));
  OutputFile elements(comm, names[2]);
  const NodeNumbers numbers(comm, mesh, path);
  // The usual shares of the time.
  const auto part = [&](double from, double to) {
    return MeshWriting{writing.buffer_bytes, part_of_stage(writing.progress, from, to)};
  };
  write_nodes(comm, mesh, numbers, part(0, 0.5), *parts[0]);
  write_triples(comm, mesh, *parts[1], fmt::format("{} 3\n", mesh.triangle_count()), part(0.5, 0.75),
                [&](std::size_t k) { return NeighbourNumbers(mesh.slabs[k]); });
  write_triples(comm, mesh, elements, fmt::format("{} 3 0\n", mesh.triangle_count()), part(0.75, 1),
                [&](std::size_t k) {
                  return [&, k](GlobalIndex side) {
                    return numbers.of_vertex(k, mesh.slabs[k].triangles.corners[at(side)]);
                  };
                });
  if (mesh.domain) {
    names.insert(names.begin(), without_extension(path) + ".poly");
    parts.push_back(std::make_unique<OutputFile>(comm, names.front()));
    collectively(comm, [&] {
      if (!mesh.slabs.empty()) {
        const std::string text = poly_text(mesh, numbers);
        parts.back()->write_at(0, std::as_bytes(std::span(text)));
      }
    });
  }
  commit_together(comm, parts, elements);
  return names;
}

} // namespace dovetail
