/// What a mesh file says before its long columns, checked against itself and against the file. Private to io.
#pragma once

#include "hdf5.hpp"
#include "vtkhdf.hpp"

#include "dovetail/base/point_table.hpp"
#include "dovetail/distributed/mesh.hpp"

#include <optional>
#include <string>
#include <vector>

namespace dovetail::vtkhdf {

struct Header {
  int format_version = 0;
  std::string program_version;
  Axis axis = Axis::x;
  std::uint64_t checksum = 0;
  GlobalIndex hull_edges = 0;
  InputDigest digest;
  Extents extents;
  std::vector<double> lines;
  std::vector<std::string> attribute_names;
  std::vector<CoordinateSystemRecord> coordinate_system;
  std::optional<DomainRecord> domain; ///< without what there is one of for each triangle

  bool has_z() const;
};

/// A mesh file open for reading on this rank alone. Everything is Local, so that a broken file can only lead
/// to an Error (input) on this rank. Every column that is handed out has been found in the file at full
/// length, so memory taken for its rows is no more than the file's own size, up to a small factor.
class Reader {
public:
  /// Opens and checks that it is HDF5.
  explicit Reader(const std::string &path);

  /// Reads and checks everything but the contents of long columns.
  Header read_header() const;

  /// Opens a column of exactly so many rows of this type and width.
  template <class T> hdf5::Column column(const std::string &name, GlobalIndex rows, int width = 1) const {
    return open_column(name, hdf5::NumberType<T>::stored(), rows, width);
  }

  /// What a domain has for each triangle: all of it, on every rank that asks.
  void read_sides(const Header &header, DomainRecord &domain) const;

  std::int64_t file_bytes() const { return file_bytes_; }

  /// The Error that says what is wrong with this file.
  [[noreturn]] void refuse(const std::string &place, const std::string &what,
                           const std::string &remedy = "make the mesh again") const;

private:
  hdf5::Column open_column(const std::string &name, hid_t type, GlobalIndex rows, int width) const;
  hdf5::Column open_column_of_any_length(const std::string &name, hid_t type, int width) const;
  template <class T> std::vector<T> contents(const std::string &name, int width = 1) const;
  std::vector<LocalIndex> indices(const std::string &name, GlobalIndex low, GlobalIndex end,
                                  int width = 1) const;
  DomainRecord read_domain(const Header &header) const;
  std::vector<GlobalIndex> read_offsets(const std::string &name, int slabs) const;
  template <class T> T number(const std::string &object, const char *name) const;
  std::string text(const std::string &object, const char *name) const;
  std::vector<std::string> texts(const std::string &name) const;
  std::vector<CoordinateSystemRecord> records() const;
  bool exists(const std::string &name) const;
  void check_ours() const;
  void check_version(const Header &header) const;
  void read_extents(Header &header) const;

  std::string path_;
  hdf5::Handle file_;
  std::int64_t file_bytes_ = 0;
};

} // namespace dovetail::vtkhdf
