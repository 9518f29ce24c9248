#include "vtu.hpp"

#include <fmt/format.h>

#include <bit>
#include <string_view>

namespace dovetail::vtu {
namespace {

constexpr std::int64_t length_bytes = 8; // header_type="UInt64"

std::string escaped(std::string_view text) {
  std::string result;
  for (const char c : text)
    switch (c) {
    case '&':
      result += "&amp;";
      break;
    case '<':
      result += "&lt;";
      break;
    case '>':
      result += "&gt;";
      break;
    case '"':
      result += "&quot;";
      break;
    default:
      result += c;
    }
  return result;
}

std::string first_lines(std::string_view type) {
  return fmt::format(
      "<?xml version=\"1.0\"?>\n<VTKFile type=\"{}\" version=\"1.0\" byte_order=\"LittleEndian\" "
      "header_type=\"UInt64\">\n",
      type);
}

std::string attributes_of(const Array &array) {
  return fmt::format("type=\"{}\" Name=\"{}\" NumberOfComponents=\"{}\"", array.type, escaped(array.name),
                     array.components);
}

/// The XML element of a group of arrays; `offset` counts from the beginning of the appended data.
std::string element(std::string_view tag, const std::vector<Array> &arrays, std::int64_t &offset) {
  std::string text = fmt::format("<{}>\n", tag);
  for (const Array &array : arrays) {
    text += fmt::format("<DataArray {} format=\"appended\" offset=\"{}\"/>\n", attributes_of(array), offset);
    offset += length_bytes + array.bytes();
  }
  return text + fmt::format("</{}>\n", tag);
}

} // namespace

Layout layout_of(const Request &request) {
  const std::string index = request.index_bytes == 8 ? "Int64" : "Int32";
  Layout layout;
  layout.points = {{"Points", "Float64", 3, 8, request.points}};
  layout.cells = {{"connectivity", index, 1, request.index_bytes, 3 * request.triangles},
                  {"offsets", index, 1, request.index_bytes, request.triangles},
                  {"types", "UInt8", 1, 1, request.triangles}};
  layout.point_data = {{"input_index", "Int64", 1, 8, request.points}};
  if (request.has_ghosts) {
    layout.point_data.push_back({"global_number", "Int64", 1, 8, request.points});
    layout.point_data.push_back({"vtkGhostType", "UInt8", 1, 1, request.points});
  }
  for (const std::string &name : request.attributes)
    layout.point_data.push_back({name, "Float64", 1, 8, request.points});

  std::int64_t offset = 0;
  layout.head = first_lines("UnstructuredGrid");
  layout.head += fmt::format("<UnstructuredGrid>\n<Piece NumberOfPoints=\"{}\" NumberOfCells=\"{}\">\n",
                             request.points, request.triangles);
  layout.head += element("Points", layout.points, offset);
  layout.head += element("Cells", layout.cells, offset);
  layout.head += element("PointData", layout.point_data, offset);
  layout.head += "</Piece>\n</UnstructuredGrid>\n<AppendedData encoding=\"raw\">\n_";
  layout.tail = "\n</AppendedData>\n</VTKFile>\n";
  auto place = static_cast<std::int64_t>(layout.head.size());
  for (std::vector<Array> *group : {&layout.points, &layout.cells, &layout.point_data})
    for (Array &array : *group) {
      array.place = place + length_bytes;
      place = array.place + array.bytes();
    }
  layout.file_bytes = place + static_cast<std::int64_t>(layout.tail.size());
  return layout;
}

std::string summary_of(const Layout &part, const std::vector<std::string> &parts) {
  std::string text = first_lines("PUnstructuredGrid") + "<PUnstructuredGrid GhostLevel=\"0\">\n";
  const auto add = [&](std::string_view tag, const std::vector<Array> &arrays) {
    text += fmt::format("<{}>\n", tag);
    for (const Array &array : arrays)
      text += fmt::format("<PDataArray {}/>\n", attributes_of(array));
    text += fmt::format("</{}>\n", tag);
  };
  add("PPoints", part.points);
  add("PPointData", part.point_data);
  for (const std::string &name : parts)
    text += fmt::format("<Piece Source=\"{}\"/>\n", escaped(name));
  return text + "</PUnstructuredGrid>\n</VTKFile>\n";
}

} // namespace dovetail::vtu
