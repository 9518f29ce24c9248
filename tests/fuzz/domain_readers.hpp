// What must hold of any domain file, whatever its bytes.
#pragma once

#include "target.hpp"

#include "dovetail/io/domain.hpp"
#include "dovetail/mesh/planarise.hpp"

#include <cmath>
#include <functional>

namespace dovetail::fuzz {

// Reads, and brings a small domain in order: an Error, or a set of segments that fits together.
inline int check_domain(const std::uint8_t *data, std::size_t size,
                        const std::function<DomainFile(const InputFile &)> &read) {
  const InputFile file("a file", std::as_bytes(std::span(data, size)));
  try {
    const DomainFile domain = read(file);
    const SegmentSet &set = domain.set;
    const auto vertices = static_cast<LocalIndex>(set.vertices.size());
    expect(set.vertex_markers.size() == set.vertices.size(), "a marker for each vertex");
    expect(set.is_line.empty() || set.is_line.size() == set.segments.size(), "a kind for each segment");
    for (const Attribute &attribute : domain.attributes)
      expect(attribute.values.size() == set.vertices.size(), "a value for each vertex");
    for (const Point p : set.vertices)
      expect(std::isfinite(p.x) && std::isfinite(p.y) && !(p.x == 0 && std::signbit(p.x)), "a coordinate");
    for (std::size_t s = 0; s < set.segments.size(); ++s) {
      expect(set.segments[s].from >= 0 && set.segments[s].from < vertices, "the beginning of a segment");
      expect(set.segments[s].to >= 0 && set.segments[s].to < vertices, "the end of a segment");
      expect_printable(name_of_segment(domain, static_cast<LocalIndex>(s)));
    }
    if (set.segments.size() <= 200) {
      const Planarised planar = planarise(set);
      expect(planar.chain_offsets.size() == set.segments.size() + 1, "a chain for each segment");
    }
  } catch (const Error &error) {
    if (error.problem().subject != "segments") // of planarise, which knows no file
      expect_helpful(error, "a file");
  }
  return 0;
}

} // namespace dovetail::fuzz
