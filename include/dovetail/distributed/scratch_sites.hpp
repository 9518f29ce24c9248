/// The sites of a rank's slabs on disk, column by column, with their duplicates. Local.
#pragma once

#include "dovetail/base/point_table.hpp"
#include "dovetail/base/scratch_file.hpp"
#include "dovetail/base/types.hpp"

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace dovetail {

/// Rows are appended as they come, in pieces that each hold consecutive sites; later they are read by the
/// numbers of the sites. Errors as ScratchFile. Reading takes no memory but what it fills.
class ScratchSites {
public:
  ScratchSites(const std::string &folder, std::size_t attributes);

  /// Adds sites first .. first + (length of the table) - 1, of which no other piece has any.
  void append(GlobalIndex first, const PointTable &sites);
  /// Duplicates by ascending (site, input_index), of sites that no other piece has duplicates of.
  void append_duplicates(std::span<const Duplicate> duplicates);

  /// Sites first .. first + count - 1 behind what the table has; all of them are there.
  void read(GlobalIndex first, GlobalIndex count, PointTable &table) const;
  void read_points(GlobalIndex first, std::span<Point> points) const;
  /// Of the sites first .. end - 1, ascending.
  std::vector<Duplicate> read_duplicates(GlobalIndex first, GlobalIndex end) const;

  /// Adds so much to the numbers of all sites that are there.
  void renumber(GlobalIndex shift);

  std::int64_t bytes() const;

private:
  /// Consecutive rows of the files that are consecutive sites.
  struct Piece {
    GlobalIndex first, count;
    std::int64_t row;
  };
  /// A few rows of the file of duplicates, of sites from `first` to `last`; `shift` is to be added to those
  /// in the file.
  struct DuplicatePiece {
    GlobalIndex first, last;
    std::int64_t row, count;
    GlobalIndex shift;
  };
  template <class Work> void for_rows(GlobalIndex first, GlobalIndex count, Work &&work) const;

  std::vector<Piece> pieces_; ///< by ascending site
  std::vector<DuplicatePiece> duplicate_pieces_;
  ScratchFile points_, input_index_, duplicates_;
  std::vector<ScratchFile> attributes_;
};

} // namespace dovetail
