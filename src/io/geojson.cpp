// GeoJSON as a set of segments.
#include "dovetail/base/excerpt.hpp"
#include "dovetail/io/domain.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <limits>
#include <span>

namespace dovetail {
namespace {

using Json = nlohmann::json;

constexpr int deepest = 64; // collections in collections

/// Reads geometries one after the other; `place` is the path of what is read, for messages.
class GeoJson {
public:
  explicit GeoJson(const InputFile &file) : file_(file) { domain_.path = file.path(); }

  DomainFile read() {
    std::string text(static_cast<std::size_t>(file_.bytes()), ' ');
    file_.read_at(0, std::as_writable_bytes(std::span(text)));
    Json json;
    try {
      json = Json::parse(text, limit_depth);
    } catch (const Json::parse_error &error) {
      file_.refuse(
          static_cast<std::int64_t>(error.byte > 0 ? error.byte - 1 : 0), "the file is not JSON here",
          "correct it, or write it again; a comma or bracket may be missing, or the end of the file");
    } catch (const Json::out_of_range &) { // it does not say where
      refuse("", "there is a number beyond the range of doubles", "give every point finite coordinates");
    } catch (const std::invalid_argument &) {
      refuse("", "lists are in each other too deep for GeoJSON", "check what the file is");
    }
    domain_.set.even_odd = true;
    read_object(json, "", 1, 0);
    return std::move(domain_);
  }

private:
  /// Values are destroyed by recursion.
  static bool limit_depth(int depth, Json::parse_event_t, const Json &) {
    if (depth > 4 * deepest)
      throw std::invalid_argument("depth");
    return true;
  }

  [[noreturn]] void refuse(const std::string &place, const std::string &what,
                           const std::string &remedy) const {
    throw Error({ErrorKind::input, file_.path(), place.empty() ? "the whole" : place, what, remedy});
  }

  const Json &member(const Json &object, const char *name, const std::string &place) const {
    if (!object.is_object())
      refuse(place, "is not an object", "see RFC 7946 for what GeoJSON consists of");
    const auto found = object.find(name);
    if (found == object.end())
      refuse(place, fmt::format("has no \"{}\"", name), "see RFC 7946 for what GeoJSON consists of");
    return *found;
  }
  const Json &list(const Json &value, const std::string &place) const {
    if (!value.is_array())
      refuse(place, "is not a list", "see RFC 7946 for how coordinates are nested");
    return value;
  }
  static std::string inside(const std::string &place, const char *name) {
    return place.empty() ? name : place + '.' + name;
  }
  static std::string element(const std::string &place, std::size_t i) {
    return fmt::format("{}[{}]", place, i);
  }

  void read_object(const Json &object, const std::string &place, std::int32_t marker, int depth) {
    if (depth > deepest)
      refuse(place, "is in too many collections", "take the geometries out of some of them");
    const Json &type = member(object, "type", place);
    if (!type.is_string())
      refuse(inside(place, "type"), "is not a text", "name a type of GeoJSON, such as \"Polygon\"");
    const auto name = type.get<std::string>();
    if (name == "FeatureCollection")
      read_all(member(object, "features", place), inside(place, "features"), marker, depth);
    else if (name == "GeometryCollection")
      read_all(member(object, "geometries", place), inside(place, "geometries"), marker, depth);
    else if (name == "Feature")
      read_feature(object, place, marker, depth);
    else
      read_geometry(name, member(object, "coordinates", place), place, inside(place, "coordinates"), marker);
  }

  void read_all(const Json &objects, const std::string &place, std::int32_t marker, int depth) {
    for (std::size_t i = 0; i < list(objects, place).size(); ++i)
      read_object(objects[i], element(place, i), marker, depth + 1);
  }

  void read_feature(const Json &feature, const std::string &place, std::int32_t marker, int depth) {
    if (const auto properties = feature.find("properties");
        properties != feature.end() && properties->is_object())
      if (const auto own = properties->find("marker"); own != properties->end() && !own->is_null())
        marker = marker_of(*own, inside(place, "properties.marker"));
    const Json &geometry = member(feature, "geometry", place);
    if (!geometry.is_null())
      read_object(geometry, inside(place, "geometry"), marker, depth + 1);
  }

  std::int32_t marker_of(const Json &value, const std::string &place) const {
    const double number = value.is_number() ? value.get<double>() : std::nan("");
    if (!(std::fabs(number) <= std::numeric_limits<std::int32_t>::max()) || number != std::floor(number))
      refuse(place, "is not a whole number of 32 bits",
             "name markers by whole numbers, or rename the property");
    return static_cast<std::int32_t>(number);
  }

  void read_geometry(const std::string &type, const Json &coordinates, const std::string &object,
                     const std::string &place, std::int32_t marker) {
    const auto each = [&](auto &&read) {
      for (std::size_t i = 0; i < list(coordinates, place).size(); ++i)
        read(coordinates[i], element(place, i));
    };
    if (type == "Polygon")
      read_polygon(coordinates, place, marker);
    else if (type == "MultiPolygon")
      each([&](const Json &polygon, const std::string &at) { read_polygon(polygon, at, marker); });
    else if (type == "LineString")
      read_line(coordinates, place, marker, false);
    else if (type == "MultiLineString")
      each([&](const Json &line, const std::string &at) { read_line(line, at, marker, false); });
    else if (type == "Point")
      read_vertex(coordinates, place, marker);
    else if (type == "MultiPoint")
      each([&](const Json &point, const std::string &at) { read_vertex(point, at, marker); });
    else
      refuse(inside(object, "type"), fmt::format("\"{}\" is no type of GeoJSON", excerpt(type)),
             "name a type of GeoJSON, such as \"Polygon\"");
  }

  void read_polygon(const Json &rings, const std::string &place, std::int32_t marker) {
    for (std::size_t i = 0; i < list(rings, place).size(); ++i)
      read_line(rings[i], element(place, i), marker, true);
  }

  /// A ring joins its ends; the position that closes it is not a vertex of its own.
  void read_line(const Json &positions, const std::string &place, std::int32_t marker, bool is_ring) {
    const std::size_t count = list(positions, place).size();
    if (count == 0)
      return;
    if (count < 2)
      refuse(place, "has one position, and a line has two at least", "leave it out, or make it a point");
    SegmentSet &set = domain_.set;
    const LocalIndex first = next_number(set.vertices.size());
    domain_.parts.push_back({place, first, next_number(set.segments.size())});
    for (std::size_t i = 0; i < count; ++i)
      read_vertex(positions[i], element(place, i), marker);
    LocalIndex last = next_number(set.vertices.size()) - 1;
    if (is_ring && set.vertices.back() == set.vertices[static_cast<std::size_t>(first)]) {
      set.vertices.pop_back();
      set.vertex_markers.pop_back();
      --last;
    } else if (is_ring) {
      ++domain_.closed_rings;
    }
    for (LocalIndex v = first; v < last; ++v)
      add_segment({v, v + 1, marker}, is_ring);
    if (is_ring)
      add_segment({last, first, marker}, is_ring);
  }

  void add_segment(const Segment &segment, bool is_ring) {
    domain_.set.segments.push_back(segment);
    domain_.set.is_line.push_back(is_ring ? 0 : 1);
  }

  void read_vertex(const Json &position, const std::string &place, std::int32_t marker) {
    if (list(position, place).size() < 2)
      refuse(place, "is not a position of two numbers", "write positions as [x, y]");
    const auto coordinate = [&](std::size_t i) {
      const double value = position[i].is_number() ? position[i].get<double>() : std::nan("");
      if (!std::isfinite(value))
        refuse(element(place, i), "is not a finite number", "write positions as [x, y]");
      return value + 0.0; // not -0.0
    };
    next_number(domain_.set.vertices.size());
    domain_.set.vertices.push_back({coordinate(0), coordinate(1)});
    domain_.set.vertex_markers.push_back(marker);
    domain_.heights += position.size() > 2 ? 1 : 0;
  }

  LocalIndex next_number(std::size_t count) const {
    if (count >= static_cast<std::size_t>(std::numeric_limits<LocalIndex>::max()))
      throw Error({ErrorKind::resource, file_.path(), "", "it has more than 2,147,483,646 positions",
                   "divide the domain into several files"});
    return static_cast<LocalIndex>(count);
  }

  const InputFile &file_;
  DomainFile domain_;
};

} // namespace

DomainFile read_geojson(const InputFile &file) { return GeoJson(file).read(); }

} // namespace dovetail
