#include "disk_buckets.hpp"

#include <cassert>
#include <utility>

namespace dovetail {

void write_row(const PointTable &table, std::size_t i, Word *row) {
  *row++ = std::bit_cast<Word>(table.points[i].x);
  *row++ = std::bit_cast<Word>(table.points[i].y);
  *row++ = std::bit_cast<Word>(table.input_index[i]);
  for (const Attribute &attribute : table.attributes)
    *row++ = std::bit_cast<Word>(attribute.values[i]);
}

std::vector<Word> rows_of(const PointTable &table) {
  const std::size_t width = words_of_row(table);
  std::vector<Word> rows(table.points.size() * width);
  for (std::size_t i = 0; i < table.points.size(); ++i)
    write_row(table, i, &rows[i * width]);
  return rows;
}

void append_rows(std::span<const Word> rows, PointTable &table) {
  for (const Word *row = rows.data(), *end = row + rows.size(); row != end;) {
    const auto x = std::bit_cast<double>(*row++);
    table.points.push_back({x, std::bit_cast<double>(*row++)});
    table.input_index.push_back(std::bit_cast<GlobalIndex>(*row++));
    for (Attribute &attribute : table.attributes)
      attribute.values.push_back(std::bit_cast<double>(*row++));
  }
}

PointTable empty_table(const std::vector<std::string> &attributes) {
  PointTable table;
  for (const std::string &name : attributes)
    table.attributes.push_back({name, {}});
  return table;
}

DiskRoom::DiskRoom(const DiskSort &disk, std::size_t attributes) : folder(disk.folder) {
  // On the way a row is in a table, in the outbox, in what arrives, and among the rows by buckets. What is
  // sorted is a table, and records of 16 bytes twice; a margin for duplicates and allocation.
  const auto memory = static_cast<std::size_t>(std::max<std::int64_t>(0, disk.memory_bytes));
  const std::size_t row_bytes = 24 + 8 * attributes;
  chunk_rows = std::clamp<std::size_t>(memory / (8 * row_bytes), 64, std::size_t{1} << 21);
  bucket_rows = std::max<std::size_t>(64, memory / (2 * (row_bytes + 40)));
}

std::size_t DiskRoom::buckets(GlobalIndex points, std::size_t ranks) const {
  constexpr std::size_t most_of_all = std::size_t{1} << 13; // of which a sample still has some points each
  const std::size_t wanted = 3 * static_cast<std::size_t>(points) / (ranks * bucket_rows) + 1;
  return std::min(wanted, std::max<std::size_t>(1, most_of_all / ranks));
}

Splitters::Splitters(std::vector<Point> sample, std::size_t buckets, Axis axis) : axis_(axis) {
  std::sort(sample.begin(), sample.end(), TotalOrder{axis});
  // The last point is no splitter: above it the sample knows of nothing.
  for (std::size_t b = 1; b < buckets && sample.size() > 1; ++b)
    if (const Point at = sample[b * (sample.size() - 1) / buckets]; points_.empty() || points_.back() != at)
      points_.push_back(at);
}

std::int64_t DiskBuckets::rows(std::size_t bucket) const {
  std::int64_t rows = 0;
  for (const Piece &piece : pieces_[bucket])
    rows += piece.rows;
  return rows;
}

void DiskBuckets::append_grouped(std::span<const Word> words, std::span<const std::size_t> row_ends) {
  std::int64_t offset = file_.append(std::as_bytes(words));
  std::size_t begin = 0;
  for (std::size_t b = 0; b < pieces_.size(); ++b) {
    const auto rows = static_cast<std::int64_t>(row_ends[b] - begin);
    if (rows > 0)
      pieces_[b].push_back({offset, rows});
    offset += rows * static_cast<std::int64_t>(width() * sizeof(Word));
    begin = row_ends[b];
  }
}

void DiskBuckets::read_rows(std::int64_t offset, std::int64_t rows, PointTable &table) const {
  constexpr std::int64_t at_once = 4096;
  std::vector<Word> buffer;
  while (rows > 0) {
    const std::int64_t count = std::min(rows, at_once);
    buffer.resize(static_cast<std::size_t>(count) * width());
    file_.read_at(offset, std::as_writable_bytes(std::span(buffer)));
    append_rows(buffer, table);
    offset += static_cast<std::int64_t>(buffer.size() * sizeof(Word));
    rows -= count;
  }
}

PointTable DiskBuckets::read(std::size_t bucket) const {
  PointTable table = empty_table(attributes_);
  const auto count = static_cast<std::size_t>(rows(bucket));
  table.points.reserve(count);
  table.input_index.reserve(count);
  for (Attribute &attribute : table.attributes)
    attribute.values.reserve(count);
  for (const Piece &piece : pieces_[bucket])
    read_rows(piece.offset, piece.rows, table);
  return table;
}

void DiskBuckets::forget(std::size_t bucket) {
  for (const Piece &piece : std::exchange(pieces_[bucket], {}))
    file_.forget(piece.offset, piece.rows * static_cast<std::int64_t>(width() * sizeof(Word)));
}

} // namespace dovetail
