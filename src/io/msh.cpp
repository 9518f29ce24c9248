// Gmsh's MSH 4.1, binary ("MSH file format", section 10.1 of Gmsh's reference manual): one plane surface, and
// of it one partitioned surface for each slab, which has the slab's own sites and its triangles. A site is in
// one block of nodes only, so triangles on a border name nodes of other blocks, as the format has it.
// Partitions' common curves are not given, as if Gmsh had been told Mesh.PartitionCreateTopology = 0.
#include "mesh_formats.hpp"
#include "mesh_rows.hpp"

#include "dovetail/comm/agreement.hpp"
#include "dovetail/comm/collectives.hpp"
#include "dovetail/comm/exchange.hpp"

#include <array>
#include <string_view>

namespace dovetail {
namespace {

constexpr std::int32_t surface_dimension = 2, triangle_element = 2;
constexpr std::int32_t whole_surface = 1;   ///< tag of the surface that is partitioned
constexpr std::int32_t first_partition = 2; ///< tag of that of slab 0
constexpr std::int64_t block_header_bytes = 3 * 4 + 8;
constexpr std::int64_t node_bytes = 8 + 3 * 8;
constexpr std::int64_t element_bytes = 4 * 8;

/// Bytes one after another.
class Bytes {
public:
  Bytes &text(std::string_view text) {
    bytes_ += text;
    return *this;
  }
  template <class T, class... More> Bytes &add(T number, More... more) {
    std::array<std::byte, sizeof(T)> raw;
    store_little(number, raw.data());
    bytes_.append(reinterpret_cast<const char *>(raw.data()), raw.size());
    if constexpr (sizeof...(More) > 0)
      add(more...);
    return *this;
  }
  /// Counts and tags of nodes and elements are size_t in the format.
  template <class... Counts> Bytes &counts(Counts... counts) {
    return add(static_cast<std::uint64_t>(counts)...);
  }
  std::string take() { return std::move(bytes_); }

private:
  std::string bytes_;
};

struct Box {
  std::array<double, 3> low{0, 0, 0}, high{0, 0, 0};
  bool is_empty = true;

  void include(const std::array<double, 3> &point) {
    for (std::size_t i = 0; i < 3; ++i) {
      low[i] = is_empty ? point[i] : std::min(low[i], point[i]);
      high[i] = is_empty ? point[i] : std::max(high[i], point[i]);
    }
    is_empty = false;
  }
  void include_box(const Box &other) {
    if (other.is_empty)
      return;
    include(other.low);
    include(other.high);
  }
};

/// Of all vertices of a slab.
Box box_of(const SlabMesh &slab) {
  const PointTable &table = slab.vertices;
  const Attribute *z = find_z(table);
  Box box;
  for (std::size_t v = 0; v < table.points.size(); ++v)
    box.include({table.points[v].x, table.points[v].y, z != nullptr ? z->values[v] : 0.0});
  return box;
}

void add_box(Bytes &bytes, const Box &box) {
  bytes.add(box.low[0], box.low[1], box.low[2], box.high[0], box.high[1], box.high[2]);
}

std::string format_and_entities(const std::vector<Box> &boxes) {
  Box whole;
  for (const Box &box : boxes)
    whole.include_box(box);
  Bytes bytes;
  bytes.text("$MeshFormat\n4.1 1 8\n").add(std::int32_t{1}).text("\n$EndMeshFormat\n");
  bytes.text("$Entities\n").counts(0, 0, 1, 0).add(whole_surface);
  add_box(bytes, whole);
  bytes.counts(0, 0).text("\n$EndEntities\n"); // no physical groups, no bounding curves
  bytes.text("$PartitionedEntities\n").counts(boxes.size(), 0).counts(0, 0, boxes.size(), 0);
  for (std::size_t s = 0; s < boxes.size(); ++s) {
    const auto partition = static_cast<std::int32_t>(s);
    bytes.add(first_partition + partition, surface_dimension, whole_surface).counts(1).add(partition + 1);
    add_box(bytes, boxes[s]);
    bytes.counts(0, 0);
  }
  return bytes.text("\n$EndPartitionedEntities\n").take();
}

/// How many slabs have rows, the rows of slab s being offsets[s] .. offsets[s + 1] - 1: so many blocks there
/// are.
GlobalIndex blocks(const std::vector<GlobalIndex> &offsets, int slabs) {
  GlobalIndex count = 0;
  for (int s = 0; s < slabs; ++s)
    count += offsets[at(s)] < offsets[at(s) + 1] ? 1 : 0;
  return count;
}

/// The beginning of the section of nodes or elements.
std::string section_head(std::string_view name, const std::vector<GlobalIndex> &offsets, int slabs) {
  const GlobalIndex total = offsets.back();
  Bytes bytes;
  bytes.text("$").text(name).text("\n");
  return bytes.counts(blocks(offsets, slabs), total, total > 0 ? 1 : 0, total).take();
}

/// Where the pieces are.
struct Layout {
  std::string before_nodes, between, after_elements;
  std::int64_t nodes = 0, elements = 0; ///< where their first blocks are
  std::int64_t file_bytes = 0;
};

Layout layout_of(const DistributedMesh &mesh, const std::vector<Box> &boxes) {
  const int slabs = mesh.slab_count();
  const auto length = [](const std::string &text) { return static_cast<std::int64_t>(text.size()); };
  Layout layout;
  layout.before_nodes = format_and_entities(boxes) + section_head("Nodes", mesh.site_offsets, slabs);
  layout.between = "\n$EndNodes\n" + section_head("Elements", mesh.triangle_offsets, slabs);
  layout.after_elements = "\n$EndElements\n";
  layout.nodes = length(layout.before_nodes);
  layout.elements = layout.nodes + blocks(mesh.site_offsets, slabs) * block_header_bytes +
                    mesh.site_count() * node_bytes + length(layout.between);
  layout.file_bytes = layout.elements + blocks(mesh.triangle_offsets, slabs) * block_header_bytes +
                      mesh.triangle_count() * element_bytes + length(layout.after_elements);
  return layout;
}

/// Local. One slab's block of nodes and block of elements, if it has any.
void write_slab(OutputFile &file, const Layout &layout, const DistributedMesh &mesh, int s,
                const SlabMesh &slab, std::int64_t buffer_bytes) {
  const std::int32_t entity = first_partition + s;
  const GlobalIndex triangles = slab.triangles.triangle_count();
  if (slab.own_count > 0) {
    std::int64_t place =
        layout.nodes + blocks(mesh.site_offsets, s) * block_header_bytes + slab.first_site * node_bytes;
    const std::string head =
        Bytes().add(surface_dimension, entity, std::int32_t{0}).counts(slab.own_count).take();
    file.write_at(place, std::as_bytes(std::span(head)));
    place += block_header_bytes;
    write_rows<std::uint64_t>(file, place, slab.own_count, 1, buffer_bytes,
                              [&](auto begin, auto end, std::uint64_t *out) {
                                for (auto v = begin; v < end; ++v)
                                  *out++ = static_cast<std::uint64_t>(slab.first_site + v + 1);
                              });
    write_rows<double>(file, place + 8 * std::int64_t{slab.own_count}, slab.own_count, 3, buffer_bytes,
                       PointRows(slab.vertices));
  }
  if (triangles > 0) {
    const std::int64_t place = layout.elements + blocks(mesh.triangle_offsets, s) * block_header_bytes +
                               slab.first_triangle * element_bytes;
    const std::string head =
        Bytes().add(surface_dimension, entity, triangle_element).counts(triangles).take();
    file.write_at(place, std::as_bytes(std::span(head)));
    write_rows<std::uint64_t>(file, place + block_header_bytes, triangles, 4, buffer_bytes,
                              [&](auto begin, auto end, std::uint64_t *out) {
                                for (auto side = 3 * begin; side < 3 * end; ++side) {
                                  if (side % 3 == 0)
                                    *out++ = static_cast<std::uint64_t>(slab.first_triangle + side / 3 + 1);
                                  *out++ = static_cast<std::uint64_t>(
                                      global_number(slab, slab.triangles.corners[at(side)]) + 1);
                                }
                              });
  }
}

} // namespace

std::vector<std::string> write_msh(const Communicator &comm, const DistributedMesh &mesh,
                                   const std::string &path, const MeshWriting &writing) {
  std::vector<Box> own;
  own.reserve(mesh.slabs.size());
  for (const SlabMesh &slab : mesh.slabs)
    own.push_back(box_of(slab));
  const Layout layout = layout_of(mesh, all_gather_bulk<Box>(comm, own).data);
  ProgressCount count = count_of_rank(mesh, writing, layout.file_bytes);
  OutputFile file(comm, path);
  file.count_into(&count);
  make_room(comm, file, layout.file_bytes);
  collectively(comm, [&] {
    write_text_at(comm, file, 0, layout.before_nodes);
    write_text_at(comm, file, layout.elements - static_cast<std::int64_t>(layout.between.size()),
                  layout.between);
    write_text_at(comm, file, layout.file_bytes - static_cast<std::int64_t>(layout.after_elements.size()),
                  layout.after_elements);
    int s = mesh.first_slab;
    for (const SlabMesh &slab : mesh.slabs)
      write_slab(file, layout, mesh, s++, slab, writing.buffer_bytes);
  });
  file.commit();
  return {path};
}

} // namespace dovetail
