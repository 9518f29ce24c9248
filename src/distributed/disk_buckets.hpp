/// Points on disk by buckets of the total order, not yet sorted inside. Local, private to distributed.
#pragma once

#include "dovetail/base/point_table.hpp"
#include "dovetail/base/scratch_file.hpp"
#include "dovetail/distributed/sort_on_disk.hpp"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace dovetail {

/// A row is the bits of x, y, the input index and the attributes: how points travel and wait.
using Word = std::uint64_t;
inline std::size_t words_of_row(const PointTable &table) { return 3 + table.attributes.size(); }
void write_row(const PointTable &table, std::size_t i, Word *row);
std::vector<Word> rows_of(const PointTable &table);
void append_rows(std::span<const Word> rows, PointTable &table);
PointTable empty_table(const std::vector<std::string> &attributes);

/// How many rows may be in memory at a time.
struct DiskRoom {
  DiskRoom(const DiskSort &disk, std::size_t attributes);
  /// For every rank. Buckets are meant to be a third of what can be sorted, for what the sample does not see.
  std::size_t buckets(GlobalIndex points, std::size_t ranks) const;

  std::string folder;
  std::size_t chunk_rows;  ///< on the way: read, sent, arrived and by buckets, each so many
  std::size_t bucket_rows; ///< to be sorted at once
};

/// Where points are cut into buckets: bucket b has what is above splitter b - 1 and not above splitter b.
class Splitters {
public:
  /// At most so many buckets, of about as many of the distinct points each. One bucket: all are equal.
  Splitters(std::vector<Point> sample, std::size_t buckets, Axis axis);
  std::size_t buckets() const { return points_.size() + 1; }
  std::size_t bucket_of(Point point) const {
    return static_cast<std::size_t>(
        std::lower_bound(points_.begin(), points_.end(), point, TotalOrder{axis_}) - points_.begin());
  }

private:
  std::vector<Point> points_;
  Axis axis_;
};

/// One file; every bucket has pieces of it.
class DiskBuckets {
public:
  DiskBuckets(const std::string &folder, std::vector<std::string> attributes, std::size_t buckets)
      : attributes_(std::move(attributes)), file_(folder), pieces_(buckets) {}

  const std::vector<std::string> &attribute_names() const { return attributes_; }
  std::int64_t rows(std::size_t bucket) const;
  /// Every row to the bucket that `bucket_of` says of its point.
  template <class BucketOf> void append(std::span<const Word> rows, BucketOf &&bucket_of);
  PointTable read(std::size_t bucket) const;
  /// work(table) with at most so many rows at a time.
  template <class Work> void read_in_pieces(std::size_t bucket, std::size_t most, Work &&work) const;
  /// Its space is given back.
  void forget(std::size_t bucket);

private:
  struct Piece {
    std::int64_t offset, rows;
  };
  std::size_t width() const { return 3 + attributes_.size(); }
  void append_grouped(std::span<const Word> words, std::span<const std::size_t> row_ends);
  void read_rows(std::int64_t offset, std::int64_t rows, PointTable &table) const;

  std::vector<std::string> attributes_;
  ScratchFile file_;
  std::vector<std::vector<Piece>> pieces_;
};

template <class BucketOf> void DiskBuckets::append(std::span<const Word> rows, BucketOf &&bucket_of) {
  const std::size_t count = rows.size() / width();
  std::vector<std::size_t> bucket(count), ends(pieces_.size() + 1, 0);
  for (std::size_t i = 0; i < count; ++i) {
    const Word *row = &rows[i * width()];
    bucket[i] = bucket_of(Point{std::bit_cast<double>(row[0]), std::bit_cast<double>(row[1])});
    ++ends[bucket[i] + 1];
  }
  for (std::size_t b = 0; b < pieces_.size(); ++b)
    ends[b + 1] += ends[b];
  std::vector<Word> grouped(rows.size());
  for (std::size_t i = 0; i < count; ++i)
    std::copy_n(&rows[i * width()], width(), &grouped[ends[bucket[i]]++ * width()]);
  append_grouped(grouped, std::span(ends).first(pieces_.size()));
}

template <class Work>
void DiskBuckets::read_in_pieces(std::size_t bucket, std::size_t most, Work &&work) const {
  PointTable table = empty_table(attributes_);
  const auto flush = [&] {
    if (!table.points.empty())
      work(std::as_const(table));
    table = empty_table(attributes_);
  };
  for (const Piece &piece : pieces_[bucket])
    for (std::int64_t done = 0, rows = 0; done < piece.rows; done += rows) {
      rows = std::min(piece.rows - done, static_cast<std::int64_t>(most - table.points.size()));
      read_rows(piece.offset + done * static_cast<std::int64_t>(width() * sizeof(Word)), rows, table);
      if (table.points.size() == most)
        flush();
    }
  flush();
}

} // namespace dovetail
