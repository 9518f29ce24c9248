/// Slabs: points spread over the ranks in any way become distinct sites in the total order, cut at exact
/// positions.
#pragma once

#include "dovetail/base/point_table.hpp"
#include "dovetail/base/progress.hpp"
#include "dovetail/comm/communicator.hpp"
#include "dovetail/distributed/mesh.hpp"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace dovetail {

enum class AxisChoice { automatic, x, y };

/// Which of equal points represents their site: that of the lowest input index; of the lowest or the highest
/// z (among equal z, or without a z, of the lowest input index); or none, and equal points are an error.
enum class DuplicateRule { first, lowest, highest, error };

struct SlabOptions {
  int slabs = 0; ///< in all; 0: default_slab_count
  AxisChoice axis = AxisChoice::automatic;
  /// The points are promised to ascend (equal neighbours allowed) in the total order of the axis, rank after
  /// rank. Checked. An automatic axis is then x.
  bool presorted = false;
  DuplicateRule duplicates = DuplicateRule::first;
  Progress progress;
  std::string subject = "input"; ///< how errors name the input
};

class ScratchSites; // distributed/scratch_sites.hpp

/// Slab s of N has the sites floor(n * s / N) .. floor(n * (s + 1) / N) - 1 of the n distinct sites in the
/// total order. The same on all ranks: axis, site_offsets, lines, digest.
struct Slabs {
  Axis axis = Axis::x;
  std::vector<GlobalIndex> site_offsets{0, 0}; ///< slab s: site_offsets[s] .. site_offsets[s + 1] - 1
  /// lines[s - 1] bounds slab s on its left: with b = site_offsets[s], the `across` coordinate of the b-th
  /// site in the total order (of the first, if b = 0); 0 if there are no sites.
  std::vector<double> lines;
  int first_slab = 0; ///< this rank's slabs, by first_slab_of_rank; few slabs leave some ranks without any
  int own_slab_count = 0;
  PointTable sites;                  ///< of this rank's slabs, ascending in TotalOrder{axis}, without gaps
  std::vector<Duplicate> duplicates; ///< of this rank's sites, ascending by (site, input_index)
  InputDigest digest;
  /// If set, sites and duplicates wait there, and of `sites` there are the names of its attributes alone.
  std::shared_ptr<const ScratchSites> scratch;

  int slab_count() const { return static_cast<int>(site_offsets.size()) - 1; }
  GlobalIndex site_count() const { return site_offsets.back(); }
  GlobalIndex first_site() const { return site_offsets[static_cast<std::size_t>(first_slab)]; }
};

/// How this rank's slabs are looked at one by one, wherever they are. Own slabs are counted by k from 0.
/// Local. Errors (input): scratch that cannot be read.
///
/// The points of a slab, in `buffer` if they are not in memory.
std::span<const Point> points_of_slab(const Slabs &slabs, int k, std::vector<Point> &buffer);
/// A copy of all columns of a slab, with room for `more` vertices behind its sites.
PointTable table_of_slab(const Slabs &slabs, int k, std::size_t more);
std::vector<Duplicate> duplicates_of_slab(const Slabs &slabs, int k);
/// For each of these own sites, ascending, one record: the bits of its input index and its attributes.
std::vector<std::uint64_t> records_of_sites(const Slabs &slabs, std::span<const GlobalIndex> numbers);

/// The slab count for so many sites on so many ranks: about 1.5 million sites a slab, which a kernel works on
/// in cache and little memory, but not so many slabs that paths outgrow a tenth of the sites
/// (sqrt(sites) / 26); the same number for every rank, at least one where a rank has a thousand sites. Local.
int default_slab_count(GlobalIndex sites, int ranks);

/// Offsets of the slabs of so many sites: slabs + 1 numbers. Local.
std::vector<GlobalIndex> slab_offsets(GlobalIndex sites, int slabs);

/// Collective. Sorts, merges equal points and cuts at exact positions, so that for a given number of slabs
/// the result is the same for every number of ranks and every distribution of the points over them.
///
/// Every rank sorts its points (radix sort) and merges equal ones; borders are found by bisection of the
/// space of positions, counting on all ranks, so that equal points of different ranks meet on one rank and
/// ranks get equal shares; columns are exchanged one after another, and the sorted runs and equal points that
/// arrive are merged; where merging has moved the k-th distinct site, a shift puts it right. One rank does
/// the same without the exchange.
///
/// points: any distribution over the ranks, input indices distinct over all of them; consumed. No -0.0; under
/// DuplicateRule::lowest and highest no z that is not a number.
/// Memory: 16 bytes a point on top of the table, 20 on several ranks (and 32 for every merged point). Cost
/// O(n) a rank and at most 128 rounds of an all-reduce of one number a rank. Errors: equal points under
/// DuplicateRule::error; an untrue promise of `presorted`; slabs with more sites than LocalIndex allows.
Slabs sort_into_slabs(const Communicator &comm, PointTable &&points, const SlabOptions &options);

} // namespace dovetail
