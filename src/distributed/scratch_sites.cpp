#include "dovetail/distributed/scratch_sites.hpp"

#include <algorithm>
#include <cassert>
#include <utility>

namespace dovetail {
namespace {

template <class Value> std::int64_t append_to(ScratchFile &file, std::span<const Value> values) {
  return file.append(std::as_bytes(values)) / static_cast<std::int64_t>(sizeof(Value));
}

template <class Value> void read_from(const ScratchFile &file, std::int64_t row, std::span<Value> values) {
  file.read_at(row * static_cast<std::int64_t>(sizeof(Value)), std::as_writable_bytes(values));
}

/// Makes room for `count` values more and returns it.
template <class Value> std::span<Value> extend(std::vector<Value> &values, GlobalIndex count) {
  const std::size_t before = values.size();
  values.resize(before + static_cast<std::size_t>(count));
  return std::span(values).subspan(before);
}

} // namespace

ScratchSites::ScratchSites(const std::string &folder, std::size_t attributes)
    : points_(folder), input_index_(folder), duplicates_(folder) {
  for (std::size_t a = 0; a < attributes; ++a)
    attributes_.emplace_back(folder);
}

void ScratchSites::append(GlobalIndex first, const PointTable &sites) {
  assert(sites.attributes.size() == attributes_.size());
  if (sites.points.empty())
    return;
  const Piece piece{first, std::ssize(sites.points), append_to<Point>(points_, sites.points)};
  append_to<GlobalIndex>(input_index_, sites.input_index);
  for (std::size_t a = 0; a < attributes_.size(); ++a)
    append_to<double>(attributes_[a], sites.attributes[a].values);
  if (!pieces_.empty() && pieces_.back().first + pieces_.back().count == first &&
      pieces_.back().row + pieces_.back().count == piece.row)
    pieces_.back().count += piece.count;
  else
    pieces_.insert(std::ranges::upper_bound(pieces_, first, {}, &Piece::first), piece);
}

void ScratchSites::append_duplicates(std::span<const Duplicate> duplicates) {
  constexpr std::size_t most = 4096; // few enough to read in vain, many enough to be few pieces
  for (; !duplicates.empty(); duplicates = duplicates.subspan(std::min(most, duplicates.size()))) {
    const auto some = duplicates.first(std::min(most, duplicates.size()));
    const std::int64_t row = append_to<Duplicate>(duplicates_, some);
    const DuplicatePiece piece{some.front().site, some.back().site, row, std::ssize(some), 0};
    duplicate_pieces_.insert(
        std::ranges::upper_bound(duplicate_pieces_, piece.first, {}, &DuplicatePiece::first), piece);
  }
}

template <class Work> void ScratchSites::for_rows(GlobalIndex first, GlobalIndex count, Work &&work) const {
  const GlobalIndex end = first + count;
  auto piece = std::ranges::upper_bound(pieces_, first, {}, &Piece::first);
  if (count > 0)
    --piece;
  for (; first < end; ++piece) {
    const GlobalIndex until = std::min(end, piece->first + piece->count);
    assert(piece != pieces_.end() && piece->first <= first && first < until);
    work(piece->row + first - piece->first, first, until - first);
    first = until;
  }
}

void ScratchSites::read(GlobalIndex first, GlobalIndex count, PointTable &table) const {
  for_rows(first, count, [&](std::int64_t row, GlobalIndex, GlobalIndex rows) {
    read_from(points_, row, extend(table.points, rows));
    read_from(input_index_, row, extend(table.input_index, rows));
    for (std::size_t a = 0; a < attributes_.size(); ++a)
      read_from(attributes_[a], row, extend(table.attributes[a].values, rows));
  });
}

void ScratchSites::read_points(GlobalIndex first, std::span<Point> points) const {
  const GlobalIndex begin = first;
  for_rows(first, std::ssize(points), [&](std::int64_t row, GlobalIndex at, GlobalIndex rows) {
    read_from(points_, row,
              points.subspan(static_cast<std::size_t>(at - begin), static_cast<std::size_t>(rows)));
  });
}

std::vector<Duplicate> ScratchSites::read_duplicates(GlobalIndex first, GlobalIndex end) const {
  std::vector<Duplicate> found;
  std::vector<Duplicate> buffer;
  for (const DuplicatePiece &piece : duplicate_pieces_) {
    if (piece.last < first)
      continue;
    if (piece.first >= end)
      break;
    buffer.clear();
    read_from(duplicates_, piece.row, extend(buffer, piece.count));
    for (Duplicate &duplicate : buffer) {
      duplicate.site += piece.shift;
      if (duplicate.site >= first && duplicate.site < end)
        found.push_back(duplicate);
    }
  }
  return found;
}

void ScratchSites::renumber(GlobalIndex shift) {
  for (Piece &piece : pieces_)
    piece.first += shift;
  for (DuplicatePiece &piece : duplicate_pieces_) {
    piece.first += shift;
    piece.last += shift;
    piece.shift += shift;
  }
}

std::int64_t ScratchSites::bytes() const {
  std::int64_t bytes = points_.bytes() + input_index_.bytes() + duplicates_.bytes();
  for (const ScratchFile &attribute : attributes_)
    bytes += attribute.bytes();
  return bytes;
}

} // namespace dovetail
