// The mesh beside its input: joined by input index, so that every point finds its site or duplicate.
#include "validation.hpp"

#include <fmt/format.h>

#include <bit>
#include <limits>
#include <tuple>

namespace dovetail::validation {
namespace {

/// One point as the input or the mesh has it.
struct Entry {
  GlobalIndex input_index;
  Point point;
  double z;
};

using Bits = std::tuple<GlobalIndex, std::uint64_t, std::uint64_t, std::uint64_t>;
Bits bits_of(const Entry &entry) {
  // Adding zero turns -0.0 into 0.0, which is the same coordinate.
  const auto bits = [](double value) { return std::bit_cast<std::uint64_t>(value + 0.0); };
  return {entry.input_index, bits(entry.point.x), bits(entry.point.y), bits(entry.z)};
}

/// Those with an index from first to last.
void add_input(const PointTable &points, GlobalIndex first, GlobalIndex last, std::vector<Entry> &entries) {
  const std::vector<double> *z = z_of(points);
  for (std::size_t i = 0; i < points.points.size(); ++i)
    if (const GlobalIndex index = points.input_index[i]; index >= first && index <= last)
      entries.push_back({index, points.points[i], z ? (*z)[i] : 0.0});
}

void add_mesh(SlabSource &source, GlobalIndex first, GlobalIndex last, std::vector<Entry> &entries) {
  const std::vector<GlobalIndex> &offsets = source.common().site_offsets;
  for (int k = 0; k < source.own_slab_count(); ++k) {
    const std::size_t s = at(source.common().first_slab + k);
    const GlobalIndex own = offsets[s + 1] - offsets[s];
    const PointTable &vertices = source.vertices(k);
    const std::vector<double> *z = z_of(vertices);
    for (std::size_t v = 0; v < at(own); ++v)
      if (const GlobalIndex index = vertices.input_index[v]; index >= first && index <= last)
        entries.push_back({index, vertices.points[v], z ? (*z)[v] : 0.0});
    for (const Duplicate &entry : source.duplicates(k))
      if (entry.site >= offsets[s] && entry.site < offsets[s + 1] && entry.input_index >= first &&
          entry.input_index <= last)
        entries.push_back({entry.input_index, vertices.points[at(entry.site - offsets[s])], entry.z});
  }
}

std::string text_of(const Entry &entry) {
  return fmt::format("point {} {} with z {:.17g}", entry.input_index, validation::text_of(entry.point),
                     entry.z);
}

void compare(std::vector<Entry> &input, std::vector<Entry> &mesh, Findings &findings) {
  std::ranges::sort(input, {}, bits_of);
  std::ranges::sort(mesh, {}, bits_of);
  auto i = input.begin();
  auto m = mesh.begin();
  while (i != input.end() || m != mesh.end()) {
    const bool only_input = m == mesh.end() || (i != input.end() && bits_of(*i) < bits_of(*m));
    const bool only_mesh = !only_input && (i == input.end() || bits_of(*m) < bits_of(*i));
    if (only_input)
      findings.add(ViolationKind::input,
                   [&] { return "the input has " + text_of(*i) + ", and the mesh has it not"; });
    else if (only_mesh)
      findings.add(ViolationKind::input,
                   [&] { return "the mesh has " + text_of(*m) + ", and the input has it not"; });
    else
      ++findings.counts.input_points;
    i += !only_mesh;
    m += !only_input;
  }
}

constexpr GlobalIndex indices_at_once = GlobalIndex{1}
                                        << 22; ///< for every rank: two entries of 32 bytes each

} // namespace

/// In rounds, so that a rank needs memory for a part of the points only; every round has a range of indices
/// for every rank to compare.
void check_input(const Communicator &comm, SlabSource &source, const PointTable &points, Findings &findings) {
  constexpr GlobalIndex lowest = std::numeric_limits<GlobalIndex>::min();
  constexpr GlobalIndex highest = std::numeric_limits<GlobalIndex>::max();
  GlobalIndex last = 0;
  for (const GlobalIndex index : points.input_index)
    last = std::max(last, index);
  last = all_reduce_max(comm, last);

  const GlobalIndex share = std::min(indices_at_once, last / comm.size() + 1);
  for (GlobalIndex begin = 0; begin <= last; begin += share * comm.size()) {
    const GlobalIndex end = begin + share * comm.size();
    const auto rank_of = [&](const Entry &entry) {
      return static_cast<int>(
          std::clamp<GlobalIndex>((entry.input_index - begin) / share, 0, comm.size() - 1));
    };
    // What the mesh has beyond all that the input has is compared with the first and last rounds.
    const auto mesh_part = [&] {
      std::vector<Entry> own;
      add_mesh(source, begin == 0 ? lowest : begin, end > last ? highest : end - 1, own);
      return own;
    };
    std::vector<Entry> of_mesh = deliver(comm, mesh_part, rank_of);
    const auto input_part = [&] {
      std::vector<Entry> own;
      add_input(points, begin == 0 ? lowest : begin, end - 1, own);
      return own;
    };
    std::vector<Entry> of_input = deliver(comm, input_part, rank_of);
    compare(of_input, of_mesh, findings);
  }
}

} // namespace dovetail::validation
