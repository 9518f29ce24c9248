/// VTK's XML files of unstructured grids, .vtu, with their arrays appended raw: which array is where. Private
/// to io. The format is told in "VTK File Formats" (Kitware, 2010 and later) and vtk.org's wiki, "VTK XML
/// Formats".
#pragma once

#include "dovetail/base/types.hpp"

#include <cstdint>
#include <string>
#include <vector>

namespace dovetail::vtu {

struct Request {
  GlobalIndex points = 0;
  GlobalIndex triangles = 0;
  int index_bytes = 8;                 ///< of connectivity and offsets
  bool has_ghosts = false;             ///< vtkGhostType and global_number as well
  std::vector<std::string> attributes; ///< without z
};

/// One array of the file.
struct Array {
  std::string name;
  std::string type; ///< in VTK's words
  int components = 1;
  int number_bytes = 8;
  GlobalIndex rows = 0;
  std::int64_t place = 0; ///< byte in the file where the numbers begin; 8 bytes before that, their length
  std::int64_t bytes() const { return rows * components * number_bytes; }
};

/// A file but for the contents of its arrays.
struct Layout {
  std::string head; ///< all up to the first array
  std::string tail; ///< all after the last one
  std::vector<Array> points, cells, point_data;
  std::int64_t file_bytes = 0;
};

Layout layout_of(const Request &request);

/// The summary, .pvtu, of parts that all have these arrays.
std::string summary_of(const Layout &part, const std::vector<std::string> &parts);

} // namespace dovetail::vtu
