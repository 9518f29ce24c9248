/// A distributed mesh as rows of numbers, which is what every format of files is made of. Private to io.
#pragma once

#include "dovetail/comm/communicator.hpp"
#include "dovetail/distributed/mesh.hpp"
#include "dovetail/distributed/slab_sink.hpp"
#include "dovetail/io/little_endian.hpp"
#include "dovetail/io/mesh.hpp"
#include "dovetail/io/output_file.hpp"

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace dovetail {

template <class T> std::size_t at(T index) { return static_cast<std::size_t>(index); }

/// Collective: the names of the attributes, the same on all ranks. A rank without slabs does not know them.
std::vector<std::string> gather_attribute_names(const Communicator &comm, const DistributedMesh &mesh);

/// The attribute "z", or null.
const Attribute *find_z(const PointTable &table);

/// Local. Throws Error (input) about `path` unless the arrays of this rank's slabs fit each other, so that a
/// writer can follow every index. A mesh that was read from a file may hold anything.
void check_indices(const DistributedMesh &mesh, const std::string &path);

/// Collective. Room for the file aside, as far as the system tells.
void make_room(const Communicator &comm, const OutputFile &file, std::int64_t bytes);

/// Local. For the bytes of a file, or several, that this rank will write: of `bytes` in all about as large a
/// part as its sites and triangles are of all.
ProgressCount count_of_rank(const MeshOutline &outline, const MeshWriting &writing, std::int64_t bytes);
ProgressCount count_of_rank(const DistributedMesh &mesh, const MeshWriting &writing, std::int64_t bytes);

/// Local. The text at `offset`, on the first rank of `comm`; nothing on the others.
void write_text_at(const Communicator &comm, OutputFile &file, std::int64_t offset, const std::string &text);

/// Global number of a slab's vertex.
inline GlobalIndex global_number(const SlabMesh &slab, LocalIndex v) {
  return v < slab.own_count ? slab.first_site + v : slab.ghost_number[at(v - slab.own_count)];
}

/// Global numbers of a slab's neighbours, asked for by ascending side.
class NeighbourNumbers {
public:
  explicit NeighbourNumbers(const SlabMesh &slab) : slab_(slab), border_(slab.border_sides.begin()) {}

  /// Of the triangle beyond `side` = 3 * triangle + corner; -1 beyond the hull.
  GlobalIndex operator()(GlobalIndex side) {
    while (border_ != slab_.border_sides.end() && border_->side < side)
      ++border_;
    if (border_ != slab_.border_sides.end() && border_->side == side)
      return border_->neighbour;
    const LocalIndex neighbour = slab_.triangles.neighbours[at(side)];
    return neighbour < 0 ? none : slab_.first_triangle + neighbour;
  }

private:
  const SlabMesh &slab_;
  std::vector<BorderSide>::const_iterator border_;
};

/// Local. Writes `count` rows of `width` little-endian numbers from byte `offset` on, made piece by piece in
/// a buffer of about `buffer_bytes`: fill(begin, end, out) puts rows begin .. end - 1 to `out`. Rows of T =
/// std::byte are records that `fill` stores itself.
template <class T, class Fill>
void write_rows(OutputFile &file, std::int64_t offset, GlobalIndex count, int width,
                std::int64_t buffer_bytes, Fill &&fill) {
  const auto row_bytes = static_cast<std::int64_t>(sizeof(T)) * width;
  const GlobalIndex step = std::min(count, std::max<GlobalIndex>(1, buffer_bytes / row_bytes));
  std::vector<T> buffer(at(step * width));
  for (GlobalIndex begin = 0; begin < count; begin += step) {
    const GlobalIndex end = std::min(count, begin + step);
    fill(begin, end, buffer.data());
    const auto numbers = std::span(buffer).first(at((end - begin) * width));
    if constexpr (std::endian::native == std::endian::big && sizeof(T) > 1)
      for (T &number : numbers)
        store_little(T(number), reinterpret_cast<std::byte *>(&number));
    file.write_at(offset + begin * row_bytes, std::as_bytes(numbers));
  }
}

/// The first `count` points of a table as rows x, y, z; z = 0 where there is none.
class PointRows {
public:
  explicit PointRows(const PointTable &table) : points_(table.points), z_(find_z(table)) {}
  void operator()(GlobalIndex begin, GlobalIndex end, double *out) const {
    for (GlobalIndex v = begin; v < end; ++v) {
      *out++ = points_[at(v)].x;
      *out++ = points_[at(v)].y;
      *out++ = z_ != nullptr ? z_->values[at(v)] : 0.0;
    }
  }

private:
  const std::vector<Point> &points_;
  const Attribute *z_;
};

} // namespace dovetail
