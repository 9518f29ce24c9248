/// Domain files: outlines, lines, holes and regions, as they were drawn. Local: one process reads all of it.
///
///   .poly     Triangle's planar straight-line graphs (Shewchuk, Triangle, 1996). Four parts, each of a line
///             with its number of lines and these: vertices (number, x, y, attributes, marker; with the
///             header of a .node file, or 0 vertices, which then are in NAME.node), segments (number, two
///             vertices, marker), holes (number, x, y), and regions, which may be absent (number, x, y,
///             attribute, greatest area of a triangle; without one, or if it is not positive, there is none).
///             Vertices count up from 0 or from 1. Comments, blanks and numbers are those of text
///             (io/text.hpp).
///   .geojson .json  GeoJSON (RFC 7946): polygons are outlines with holes by even-odd nesting; lines are
///             segments that may hang or cross; points are vertices. Features with an integer property
///             "marker" give it to their segments and vertices; else segments have 1. Coordinates are taken
///             as they are, and a third one is left out (and counted). A ring that does not end where it
///             began is closed (and counted).
///
/// Coordinates must be finite; -0.0 becomes 0.0. Nothing is mended here: mesh/planarise.hpp does that.
#pragma once

#include "dovetail/base/point_table.hpp"
#include "dovetail/io/input_file.hpp"
#include "dovetail/mesh/planarise.hpp"

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace dovetail {

/// Where the segments and vertices of a ring, line or table come from.
struct DomainPart {
  std::string place;        ///< a path such as "features[3].geometry.coordinates[0]"
  LocalIndex first_vertex;  ///< that of its position 0
  LocalIndex first_segment; ///< that from its position 0 to 1
};

struct DomainFile {
  std::string path;
  SegmentSet set;
  std::vector<Attribute> attributes;       ///< of the vertices
  int first_number = 0;                    ///< of vertices and segments, in the file's own words
  std::vector<std::int64_t> segment_lines; ///< .poly: of the file, from 1
  std::vector<DomainPart> parts;           ///< GeoJSON
  GlobalIndex closed_rings = 0;            ///< that did not end where they began
  GlobalIndex heights = 0;                 ///< third coordinates left out
};

/// Whether the extension of the name is one of the above.
bool is_domain_file(std::string_view path);
inline constexpr const char *domain_extensions = ".poly, .geojson or .json";

/// Errors (input): missing, unreadable, malformed; with line and character for .poly, byte or path for
/// GeoJSON. (usage): another extension.
DomainFile read_domain(const std::string &path);

/// The readers by themselves, for files in memory. `nodes`: NAME.node, where the .poly has no vertices; null
/// to open it.
DomainFile read_poly(const InputFile &file, const InputFile *nodes = nullptr);
DomainFile read_geojson(const InputFile &file);

/// For messages: number and place of a segment, such as "segment 17 (line 40)".
std::string name_of_segment(const DomainFile &file, LocalIndex segment);

} // namespace dovetail
