/// What the parts of the distributed validator share. Private to distributed.
#pragma once

#include "dovetail/comm/agreement.hpp"
#include "dovetail/comm/collectives.hpp"
#include "dovetail/comm/exchange.hpp"
#include "dovetail/distributed/mesh.hpp"
#include "dovetail/distributed/slab_source.hpp"
#include "dovetail/distributed/validate.hpp"

#include <algorithm>
#include <concepts>
#include <initializer_list>
#include <numeric>
#include <optional>
#include <string>
#include <vector>

namespace dovetail::validation {

template <class T> std::size_t at(T index) { return static_cast<std::size_t>(index); }

std::string text_of(Point p);

/// What this rank has found so far: counts, and the first few violations of every kind in words.
class Findings {
public:
  static constexpr GlobalIndex kept_of_each_kind = 3;

  /// `describe` makes the text, and is only asked when the text will be kept.
  template <class Describe> void add(ViolationKind kind, Describe &&describe) {
    GlobalIndex &count = counts.violations_by_kind[at(kind)];
    if (count++ < kept_of_each_kind)
      counts.first_violations.push_back({kind, describe()});
  }
  bool any() const {
    return std::ranges::any_of(counts.violations_by_kind, [](GlobalIndex count) { return count > 0; });
  }
  /// Forgets all violations of other kinds.
  void keep_only(std::initializer_list<ViolationKind> kinds);

  ValidationReport counts; ///< this rank's share
};

/// Who owns which slab, site and triangle. The same on all ranks.
class Ownership {
public:
  /// `first_slabs` of all ranks, and the number of slabs at the end.
  Ownership(const DistributedMesh &mesh, std::vector<int> first_slabs)
      : sites_(mesh.site_offsets), triangles_(mesh.triangle_offsets), first_slabs_(std::move(first_slabs)) {}

  int rank_of_slab(int slab) const { return static_cast<int>(last_not_above(first_slabs_, slab)); }
  int slab_of_site(GlobalIndex number) const { return static_cast<int>(last_not_above(sites_, number)); }
  int slab_of_triangle(GlobalIndex number) const {
    return static_cast<int>(last_not_above(triangles_, number));
  }
  int rank_of_site(GlobalIndex number) const { return rank_of_slab(slab_of_site(number)); }
  int rank_of_triangle(GlobalIndex number) const { return rank_of_slab(slab_of_triangle(number)); }

private:
  /// Where offsets repeat, the last is the one that is not empty.
  template <class T> static std::ptrdiff_t last_not_above(const std::vector<T> &offsets, T value) {
    return std::upper_bound(offsets.begin(), offsets.end(), value) - offsets.begin() - 1;
  }

  const std::vector<GlobalIndex> &sites_;
  const std::vector<GlobalIndex> &triangles_;
  std::vector<int> first_slabs_;
};

/// What a rank lacks memory for, if it does.
inline const char *checking_text() { return "checking the mesh"; }

/// Items by the ranks that they go to.
template <Bulk T> struct Mail {
  std::vector<T> items;
  std::vector<Outgoing<T>> letters; ///< pieces of `items`
};

template <Bulk T, class RankOf> Mail<T> mail_of(const std::vector<T> &items, RankOf &&rank_of) {
  std::vector<std::pair<int, std::size_t>> order;
  order.reserve(items.size());
  for (std::size_t i = 0; i < items.size(); ++i)
    order.emplace_back(rank_of(items[i]), i);
  std::sort(order.begin(), order.end());
  Mail<T> mail;
  std::vector<T> &sorted = mail.items;
  sorted.reserve(items.size());
  std::vector<std::pair<int, std::size_t>> begins; // of every rank's letter
  for (const auto &[rank, i] : order) {
    if (begins.empty() || begins.back().first != rank)
      begins.emplace_back(rank, sorted.size());
    sorted.push_back(items[i]);
  }
  for (std::size_t k = 0; k < begins.size(); ++k) {
    const std::size_t end = k + 1 < begins.size() ? begins[k + 1].second : sorted.size();
    mail.letters.push_back(
        {begins[k].first, std::span<const T>(sorted).subspan(begins[k].second, end - begins[k].second)});
  }
  return mail;
}

/// Collective: every one of the items that `make` makes goes to the rank that `rank_of` names; returns what
/// came here.
template <std::invocable Make, class RankOf>
auto deliver(const Communicator &comm, Make &&make, RankOf &&rank_of) {
  const auto mail = collectively(comm, checking_text, [&] { return mail_of(make(), rank_of); });
  using T = typename std::remove_cvref_t<decltype(mail.items)>::value_type;
  const auto incoming = sparse_exchange<T>(comm, mail.letters);
  return collectively(comm, checking_text, [&] {
    std::vector<T> received;
    for (const Incoming<T> &letter : incoming)
      received.insert(received.end(), letter.data.begin(), letter.data.end());
    return received;
  });
}
/// The same, of items that are there.
template <Bulk T, class RankOf>
std::vector<T> deliver(const Communicator &comm, const std::vector<T> &items, RankOf &&rank_of) {
  return deliver(
      comm, [&]() -> const std::vector<T> & { return items; }, rank_of);
}

/// Calls visit(side) for every side of a slab's triangles with nothing beyond.
template <class Visit> void for_each_hull_side(const SlabMesh &slab, Visit &&visit) {
  auto border = slab.border_sides.begin();
  for (std::size_t side = 0; side < slab.triangles.neighbours.size(); ++side) {
    if (slab.triangles.neighbours[side] != none)
      continue;
    if (border != slab.border_sides.end() && at(border->side) == side)
      ++border;
    else
      visit(static_cast<LocalIndex>(side));
  }
}

/// Global number of a slab's vertex.
inline GlobalIndex number_of(const SlabMesh &slab, LocalIndex v) {
  return v < slab.own_count ? slab.first_site + v : slab.ghost_number[at(v - slab.own_count)];
}

/// A side of a slab's triangle: from `from` to `to` is counter-clockwise, `apex` is across.
struct Side {
  LocalIndex from, to, apex;
};
inline Side side_of(const SlabMesh &slab, LocalIndex side) {
  const LocalIndex base = side - side % 3;
  const std::vector<LocalIndex> &corners = slab.triangles.corners;
  return {corners[at(base + (side + 1) % 3)], corners[at(base + (side + 2) % 3)], corners[at(side)]};
}

inline Point point_of(const SlabMesh &slab, LocalIndex v) { return slab.vertices.points[at(v)]; }

/// The z of a slab's vertices, or nullptr.
const std::vector<double> *z_of(const PointTable &table);

/// "slab 3, triangle 12 (sites 4, 5, 6)", in global numbers.
std::string place_of(const SlabMesh &slab, int s, LocalIndex triangle);

// What slabs have to say to each other. All of it is as short as borders, ghosts, hull and paths are.

/// The triangle on one side of a border, as it sees the border.
struct BorderNotice {
  GlobalIndex triangle;  ///< that tells
  GlobalIndex neighbour; ///< that it names
  GlobalIndex from, to;  ///< the edge as the teller has it, in global site numbers
  GlobalIndex apex;
  Point from_point, to_point, apex_point;
  std::int64_t slab;     ///< of the teller
  std::int64_t oriented; ///< 1: the teller is counter-clockwise
};

/// A ghost, told to the owner of its site.
struct GhostNotice {
  GlobalIndex number;
  Point point;
  GlobalIndex input_index;
  std::uint64_t attributes; ///< hash of their bits
  std::int64_t slab;        ///< that has the ghost
};

/// One end of a hull edge, told to the owner of the site there.
struct HullNotice {
  GlobalIndex site;
  GlobalIndex other;
  Point site_point, other_point;
  std::int64_t leaves; ///< 1: the edge goes from site to other; 0: from other to site
};

/// An edge that the path of a line must have, upwards along the line.
struct PathNotice {
  std::int64_t slab; ///< right of the line
  GlobalIndex from, to;
  friend auto operator<=>(const PathNotice &, const PathNotice &) = default;
};

/// A site and where it is.
struct SiteAt {
  GlobalIndex number;
  Point point;
};

/// The first and the last of a slab's own sites, if it has any.
struct SlabEnds {
  Point first, last;
  std::int64_t count;
};

/// What one reading of all slabs of a rank leaves behind.
struct Gathered {
  std::vector<BorderNotice> borders;
  std::vector<HullNotice> hull;
  std::vector<PathNotice> path_edges;
  std::vector<std::vector<GlobalIndex>> left_paths; ///< one an own slab
  std::optional<SiteAt> first_site, last_site;      ///< of the rank
  std::vector<SlabEnds> slab_ends;                  ///< one an own slab
  std::vector<std::uint64_t> attribute_names;       ///< one hash an own slab
  std::uint64_t checksum = 0;
  InputDigest digest;    ///< of sites and duplicates
  bool is_sound = true;  ///< array sizes and index ranges fit together
  bool is_finite = true; ///< all coordinates
};

// The parts. Those named gather_ look at one slab and are Local; the others are Collective, and but for the
// first need slabs that are sound and finite on all ranks. All add to `findings`.

/// Returns the first slab of every rank and the number of slabs, or nothing, on all ranks alike, if what all
/// ranks share does not fit together.
std::vector<int> check_common(const Communicator &comm, const SlabSource &source, Findings &findings);
/// True if array sizes and index ranges of slab s fit together and its coordinates are finite: nothing else
/// may look at it otherwise.
bool gather_layout(const DistributedMesh &common, const SlabMesh &slab, std::size_t s, Gathered &gathered,
                   Findings &findings);
/// The order of own sites, also against those of the slab before on this rank, and lines.
void gather_order(const DistributedMesh &common, const SlabMesh &slab, Gathered &gathered,
                  Findings &findings);
/// Every triangle's orientation and slab, every inner edge but those on borders.
void gather_triangles(const DistributedMesh &common, const SlabMesh &slab, int s, ProgressCount &done,
                      Findings &findings);
void gather_borders(const SlabMesh &slab, int s, Gathered &gathered);
void gather_hull(const SlabMesh &slab, Gathered &gathered, Findings &findings);
void gather_paths(const DistributedMesh &common, const SlabMesh &slab, int s, const Ownership &owners,
                  Gathered &gathered);
/// `ghosts`: what others say of sites, all that arrived here.
void gather_sites(const SlabMesh &slab, int s, std::span<const GhostNotice> ghosts, Findings &findings);
void gather_sums(const SlabMesh &slab, std::span<const Duplicate> duplicates, Gathered &gathered,
                 Findings &findings);

/// All ghosts of all ranks, told to the owners of their sites; by ascending number.
std::vector<GhostNotice> ghosts_of_own_sites(const Communicator &comm, SlabSource &source,
                                             const Ownership &owners);
/// Whether what was gathered can be relied on, on all ranks alike.
bool check_soundness(const Communicator &comm, const DistributedMesh &common, const Gathered &gathered,
                     Findings &findings);
void check_order_across_ranks(const Communicator &comm, const DistributedMesh &common,
                              const Gathered &gathered, Findings &findings);
void check_borders(const Communicator &comm, const Ownership &owners, const Gathered &gathered,
                   Findings &findings);
void check_hull(const Communicator &comm, const DistributedMesh &common, const Ownership &owners,
                const Gathered &gathered, Findings &findings);
void check_paths(const Communicator &comm, const DistributedMesh &common, const Ownership &owners,
                 const Gathered &gathered, Findings &findings);
/// In place of triangles, borders, hull: there are none.
void check_collinear(const Communicator &comm, SlabSource &source, const Gathered &gathered,
                     Findings &findings);
void check_sums(const Communicator &comm, const DistributedMesh &common, const Gathered &gathered,
                Findings &findings);
void check_input(const Communicator &comm, SlabSource &source, const PointTable &points, Findings &findings);

} // namespace dovetail::validation
