#include "dovetail/distributed/sort_on_disk.hpp"

#include "choose_axis.hpp"
#include "cut_slabs.hpp"
#include "disk_buckets.hpp"
#include "dovetail/comm/agreement.hpp"
#include "dovetail/comm/collectives.hpp"
#include "dovetail/comm/exchange.hpp"
#include "dovetail/distributed/scratch_sites.hpp"
#include "dovetail/mesh/checksum.hpp"
#include "point_sketch.hpp"
#include "sort_points.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <utility>

namespace dovetail {
namespace {

std::size_t index(std::int64_t value) { return static_cast<std::size_t>(value); }

const char *purpose_text() { return "sorting on disk"; }

/// What the first reading tells, the same on all ranks.
struct Survey {
  GlobalIndex points = 0;
  std::vector<Point> sample; ///< of all points
};

constexpr std::size_t sample_size = std::size_t{1} << 16;

/// Collective.
Survey survey(const Communicator &comm, PointStream &points, const DiskRoom &room) {
  GlobalIndex count = 0;
  PointSketch sketch = collectively(comm, purpose_text, [&] {
    PointTable table = empty_table(points.attribute_names());
    PointSketch result(sample_size);
    while (points.next(room.chunk_rows, table)) {
      result.add(table.points);
      count += std::ssize(table.points);
    }
    return result;
  });
  return {all_reduce_sum(comm, count), sample_of_all(comm, std::move(sketch))};
}

/// The sample for the axis is the beginning of the larger one.
Axis axis_of(const SlabOptions &options, const std::vector<Point> &sample) {
  if (options.axis != AxisChoice::automatic)
    return options.axis == AxisChoice::x ? Axis::x : Axis::y;
  const auto first = sample.begin();
  return choose_axis({first, first + static_cast<std::ptrdiff_t>(std::min(sample.size(), axis_sample_size))});
}

/// What this rank has still to send of its latest chunk: rows by destination.
struct Outbox {
  std::vector<Word> words;
  std::vector<std::size_t> next, end; ///< for every rank, in words

  bool is_empty() const { return next == end; }
  std::vector<Outgoing<Word>> letters(std::size_t most_words) {
    std::vector<Outgoing<Word>> result;
    for (std::size_t rank = 0; rank < next.size(); ++rank) {
      const std::size_t begin = next[rank];
      next[rank] = std::min(end[rank], begin + most_words);
      if (next[rank] > begin)
        result.push_back(
            {static_cast<int>(rank), std::span(std::as_const(words)).subspan(begin, next[rank] - begin)});
    }
    return result;
  }
};

/// Rows of the table by the ranks of their buckets; every rank has `buckets_of_rank` consecutive ones.
Outbox address(const PointTable &table, const Splitters &splitters, std::size_t buckets_of_rank, int ranks) {
  std::vector<std::size_t> rank_of;
  Outbox box{{}, std::vector<std::size_t>(index(ranks), 0), {}};
  for (const Point &point : table.points)
    ++box.next[rank_of.emplace_back(splitters.bucket_of(point) / buckets_of_rank)];
  const std::size_t width = words_of_row(table);
  std::size_t begin = 0;
  for (std::size_t &next : box.next)
    begin += width * std::exchange(next, begin);
  box.end = box.next;
  box.words.resize(begin);
  for (std::size_t i = 0; i < rank_of.size(); ++i) {
    write_row(table, i, &box.words[box.end[rank_of[i]]]);
    box.end[rank_of[i]] += width;
  }
  return box;
}

/// Collective. The second reading: every point to the rank of its bucket, and the digest of all.
void spread(const Communicator &comm, PointStream &points, const Splitters &splitters,
            std::size_t buckets_of_rank, const DiskRoom &room, DiskBuckets &buckets, InputDigest &digest) {
  PointTable table = empty_table(points.attribute_names());
  const std::size_t width = words_of_row(table);
  const std::size_t most_words =
      width * std::max<std::size_t>(1, room.chunk_rows / static_cast<std::size_t>(comm.size()));
  const std::size_t first_bucket = buckets_of_rank * index(comm.rank());
  Outbox box;
  bool more = true;
  while (any_of_ranks(comm, more || !box.is_empty())) {
    const auto letters = collectively(comm, purpose_text, [&] {
      const bool reads = more && box.is_empty();
      if (reads)
        more = points.next(room.chunk_rows, table);
      if (reads && more) {
        const std::vector<double> *z = heights_of(table);
        for (std::size_t i = 0; i < table.points.size(); ++i)
          digest.hash += digest_of_point(table.points[i], z != nullptr ? (*z)[i] : 0.0, table.input_index[i]);
        digest.points += std::ssize(table.points);
        box = address(table, splitters, buckets_of_rank, comm.size());
      }
      return box.letters(most_words);
    });
    const auto incoming = sparse_exchange<Word>(comm, letters);
    collectively(comm, purpose_text, [&] {
      for (const Incoming<Word> &letter : incoming)
        buckets.append(letter.data, [&](Point p) { return splitters.bucket_of(p) - first_bucket; });
    });
  }
  digest = {all_reduce_sum(comm, digest.points), all_reduce_sum(comm, digest.hash)};
}

/// Buckets in order into sorted sites, numbered from 0 on this rank.
class SiteMaker {
public:
  SiteMaker(Axis axis, DuplicateRule rule, const DiskRoom &room, ScratchSites &sites)
      : axis_(axis), rule_(rule), room_(room), sites_(sites) {}

  GlobalIndex count() const { return count_; }

  void take(DiskBuckets &buckets, std::size_t bucket) {
    const std::int64_t rows = buckets.rows(bucket);
    if (rows <= static_cast<std::int64_t>(room_.bucket_rows))
      return sort(buckets, bucket);
    PointSketch sketch(sample_size);
    buckets.read_in_pieces(bucket, room_.chunk_rows,
                           [&](const PointTable &piece) { sketch.add(piece.points); });
    const auto parts = 2 * index(rows) / room_.bucket_rows + 2;
    const Splitters splitters(sketch.points(), parts, axis_);
    if (splitters.buckets() == 1)
      return take_equals(buckets, bucket);
    DiskBuckets finer(room_.folder, buckets.attribute_names(), splitters.buckets());
    buckets.read_in_pieces(bucket, room_.chunk_rows, [&](const PointTable &piece) {
      finer.append(rows_of(piece), [&](Point p) { return splitters.bucket_of(p); });
    });
    buckets.forget(bucket);
    for (std::size_t part = 0; part < splitters.buckets(); ++part)
      take(finer, part);
  }

private:
  void sort(DiskBuckets &buckets, std::size_t bucket) {
    PointTable table = buckets.read(bucket);
    buckets.forget(bucket);
    sort_points(table, axis_, {});
    std::vector<MergedPoint> merged;
    merge_equal_points(table, rule_, merged);
    sites_.append(count_, table);
    std::vector<Duplicate> duplicates;
    duplicates.reserve(merged.size());
    std::size_t site = 0;
    for (const MergedPoint &point : merged) {
      while (table.points[site] != point.point)
        ++site;
      duplicates.push_back({point.input_index, count_ + static_cast<GlobalIndex>(site), point.z});
    }
    std::ranges::sort(duplicates, [](const Duplicate &a, const Duplicate &b) {
      return a.site < b.site || (a.site == b.site && a.input_index < b.input_index);
    });
    sites_.append_duplicates(duplicates);
    count_ += std::ssize(table.points);
  }

  /// All of them are at one position; they need no room for being sorted.
  void take_equals(DiskBuckets &buckets, std::size_t bucket) {
    const auto most = 2 * static_cast<std::int64_t>(room_.bucket_rows);
    if (buckets.rows(bucket) > most)
      throw Error({ErrorKind::resource, "--memory", "",
                   fmt::format("{} points are at one position, and there is room to merge {}",
                               buckets.rows(bucket), most),
                   "give more memory, or leave equal points out of the input"});
    sort(buckets, bucket);
  }

  Axis axis_;
  DuplicateRule rule_;
  const DiskRoom &room_;
  ScratchSites &sites_;
  GlobalIndex count_ = 0;
};

/// Sites that are here and belong to others, and where the next round goes on.
struct Leaving {
  int rank;
  GlobalIndex next, end;
};

std::vector<Leaving> leaving_sites(const Communicator &comm, const std::vector<GlobalIndex> &rank_begins,
                                   GlobalIndex begin, GlobalIndex end) {
  std::vector<Leaving> leaving;
  for (int rank = 0; rank < comm.size(); ++rank) {
    const GlobalIndex first = std::max(begin, rank_begins[index(rank)]);
    const GlobalIndex last = std::min(end, rank_begins[index(rank) + 1]);
    if (rank != comm.rank() && first < last)
      leaving.push_back({rank, first, last});
  }
  return leaving;
}

/// Collective. Every rank gets the sites of its slabs, in rounds of bounded size.
void shift(const Communicator &comm, std::vector<Leaving> leaving, const DiskRoom &room,
           const std::vector<std::string> &attributes, ScratchSites &sites) {
  const auto most = static_cast<GlobalIndex>(
      std::max<std::size_t>(1, room.chunk_rows / static_cast<std::size_t>(comm.size())));
  struct Packet {
    std::vector<Word> sites; ///< the number of the first, then rows
    std::vector<Duplicate> duplicates;
  };
  const auto is_left = [](const Leaving &l) { return l.next < l.end; };
  while (any_of_ranks(comm, std::ranges::any_of(leaving, is_left))) {
    std::vector<Packet> packets;
    std::vector<Outgoing<Word>> rows;
    std::vector<Outgoing<Duplicate>> duplicates;
    collectively(comm, purpose_text, [&] {
      packets.reserve(leaving.size());
      for (Leaving &l : leaving) {
        if (!is_left(l))
          continue;
        const GlobalIndex end = std::min(l.end, l.next + most);
        PointTable table = empty_table(attributes);
        sites.read(l.next, end - l.next, table);
        Packet &packet = packets.emplace_back();
        packet.sites = rows_of(table);
        packet.sites.insert(packet.sites.begin(), static_cast<Word>(l.next));
        packet.duplicates = sites.read_duplicates(l.next, end);
        rows.push_back({l.rank, packet.sites});
        duplicates.push_back({l.rank, packet.duplicates});
        l.next = end;
      }
    });
    const auto arrived = sparse_exchange<Word>(comm, rows);
    const auto arrived_duplicates = sparse_exchange<Duplicate>(comm, duplicates);
    collectively(comm, purpose_text, [&] {
      for (const Incoming<Word> &letter : arrived) {
        PointTable table = empty_table(attributes);
        append_rows(std::span(letter.data).subspan(1), table);
        sites.append(static_cast<GlobalIndex>(letter.data.front()), table);
      }
      for (const Incoming<Duplicate> &letter : arrived_duplicates)
        sites.append_duplicates(letter.data);
    });
  }
}

/// The number of slabs where it is not given.
int slab_count(GlobalIndex sites, int ranks, const SlabOptions &options, const DiskSort &disk) {
  if (options.slabs > 0)
    return options.slabs;
  const GlobalIndex usual = default_slab_count(sites, ranks);
  if (disk.most_slab_sites == 0)
    return static_cast<int>(usual);
  const GlobalIndex each = (sites + disk.most_slab_sites * ranks - 1) / (disk.most_slab_sites * ranks);
  return static_cast<int>(std::max(usual, each * ranks));
}

} // namespace

Slabs sort_on_disk(const Communicator &comm, PointStream &points, const SlabOptions &options,
                   const DiskSort &disk) {
  if (options.presorted)
    throw Error({ErrorKind::usage, "--presorted", "",
                 "the points do not fit into memory, and are sorted on disk", "leave --presorted away"});
  const std::vector<std::string> &attributes = points.attribute_names();
  const DiskRoom room(disk, attributes.size());
  Survey seen = survey(comm, points, room);
  points.begin_again();

  Slabs slabs;
  slabs.sites = empty_table(attributes);
  slabs.axis = axis_of(options, seen.sample);
  const auto ranks = index(comm.size());
  const std::size_t buckets_of_rank = room.buckets(seen.points, ranks);
  auto scratch = collectively(comm, purpose_text,
                              [&] { return std::make_shared<ScratchSites>(disk.folder, attributes.size()); });
  GlobalIndex count = 0;
  {
    DiskBuckets buckets = collectively(comm, purpose_text,
                                       [&] { return DiskBuckets(disk.folder, attributes, buckets_of_rank); });
    const Splitters splitters = collectively(comm, purpose_text, [&] {
      return Splitters(std::move(seen.sample), buckets_of_rank * ranks, slabs.axis);
    });
    spread(comm, points, splitters, buckets_of_rank, room, buckets, slabs.digest);
    count = collectively(comm, purpose_text, [&] {
      SiteMaker maker(slabs.axis, options.duplicates, room, *scratch);
      for (std::size_t bucket = 0; bucket < buckets_of_rank; ++bucket) {
        maker.take(buckets, bucket);
        report_progress(options.progress, "sort",
                        0.5 + 0.5 * static_cast<double>(bucket + 1) / static_cast<double>(buckets_of_rank));
      }
      return maker.count();
    });
  }
  const GlobalIndex begin = exclusive_scan(comm, count);
  scratch->renumber(begin);
  const GlobalIndex sites = all_reduce_sum(comm, count);
  Division division = division_of(comm, sites, slab_count(sites, comm.size(), options, disk));
  shift(comm, leaving_sites(comm, division.rank_begins, begin, begin + count), room, attributes, *scratch);
  take_division(comm, std::move(division), options.subject, slabs);
  slabs.scratch = std::move(scratch);
  slabs.lines = lines_of(comm, slabs);
  if (options.duplicates == DuplicateRule::error)
    refuse_duplicates(comm, slabs, options.subject);
  return slabs;
}

} // namespace dovetail
