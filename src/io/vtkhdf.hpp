/// Names and sizes in a mesh file, shared by its writer and its reader. The layout itself is told in
/// dovetail/io/mesh.hpp. Private to io.
#pragma once

#include "dovetail/base/types.hpp"

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace dovetail::vtkhdf {

inline constexpr const char *vtk_group = "VTKHDF";
inline constexpr const char *point_data_group = "VTKHDF/PointData";
inline constexpr const char *own_group = "dovetail";
inline constexpr const char *records_group = "dovetail/coordinate_system";
inline constexpr const char *domain_group = "domain";
inline constexpr const char *cell_data_group = "VTKHDF/CellData";

inline constexpr const char *points = "VTKHDF/Points";
inline constexpr const char *connectivity = "VTKHDF/Connectivity";
inline constexpr const char *offsets = "VTKHDF/Offsets";
inline constexpr const char *types = "VTKHDF/Types";
inline constexpr const char *number_of_points = "VTKHDF/NumberOfPoints";
inline constexpr const char *number_of_cells = "VTKHDF/NumberOfCells";
inline constexpr const char *number_of_connectivity_ids = "VTKHDF/NumberOfConnectivityIds";
inline constexpr const char *ghost_type = "VTKHDF/PointData/vtkGhostType";
inline constexpr const char *input_index = "VTKHDF/PointData/input_index";
inline constexpr const char *global_number = "VTKHDF/PointData/global_number";

inline constexpr const char *site_offsets = "dovetail/site_offsets";
inline constexpr const char *triangle_offsets = "dovetail/triangle_offsets";
inline constexpr const char *path_offsets = "dovetail/path_offsets";
inline constexpr const char *duplicate_offsets = "dovetail/duplicate_offsets";
inline constexpr const char *own_counts = "dovetail/own_counts";
inline constexpr const char *lines = "dovetail/lines";
inline constexpr const char *neighbours = "dovetail/neighbours";
inline constexpr const char *paths = "dovetail/paths";
inline constexpr const char *duplicates = "dovetail/duplicates";
inline constexpr const char *duplicate_z = "dovetail/duplicate_z";
inline constexpr const char *attribute_names = "dovetail/attributes";

inline constexpr const char *region_of_cell = "VTKHDF/CellData/region";
inline constexpr const char *segments = "domain/segments";
inline constexpr const char *segment_markers = "domain/segment_markers";
inline constexpr const char *is_line = "domain/is_line";
inline constexpr const char *holes = "domain/holes";
inline constexpr const char *regions = "domain/regions";
inline constexpr const char *segment_of_side = "domain/segment_of_side";
inline constexpr const char *chain_offsets = "domain/chain_offsets";
inline constexpr const char *chain_vertices = "domain/chain_vertices";
inline constexpr const char *left_triangles = "domain/left_triangles";

inline constexpr std::string_view z_attribute = "z"; ///< kept as the third coordinate
inline constexpr std::uint8_t triangle_cell = 5;     ///< VTK_TRIANGLE
inline constexpr std::uint8_t duplicate_point = 1;   ///< vtkDataSetAttributes::DUPLICATEPOINT

/// Names in PointData that an attribute must not take.
inline constexpr std::array<std::string_view, 3> reserved_names{"vtkGhostType", "input_index",
                                                                "global_number"};

inline std::string dataset_of_attribute(const std::string &name) {
  return std::string(point_data_group) + '/' + name;
}

/// Where every slab's rows begin in each kind of column: slab s has rows offsets[s] .. offsets[s + 1] - 1.
struct Extents {
  std::vector<GlobalIndex> vertices{0};
  std::vector<GlobalIndex> sites{0};
  std::vector<GlobalIndex> triangles{0};
  std::vector<GlobalIndex> paths{0};
  std::vector<GlobalIndex> duplicates{0};

  int slabs() const { return static_cast<int>(sites.size()) - 1; }
  /// Offsets holds one entry more than triangles for every slab.
  GlobalIndex first_offset(int slab) const { return triangles[static_cast<std::size_t>(slab)] + slab; }
};

} // namespace dovetail::vtkhdf
