// From the name of a domain file to its reader, and from its segments back to their places.
#include "dovetail/io/domain.hpp"

#include "points_share.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace dovetail {

bool is_domain_file(std::string_view path) {
  const std::string extension = extension_of(path);
  return extension == ".poly" || extension == ".geojson" || extension == ".json";
}

DomainFile read_domain(const std::string &path) {
  if (!is_domain_file(path))
    throw Error({ErrorKind::usage, path, "", "its extension is not that of a domain file",
                 fmt::format("name a file that ends in {}", domain_extensions)});
  const InputFile file(path);
  return extension_of(path) == ".poly" ? read_poly(file) : read_geojson(file);
}

std::string name_of_segment(const DomainFile &file, LocalIndex segment) {
  const auto i = static_cast<std::size_t>(segment);
  if (file.parts.empty())
    return fmt::format("segment {} (line {})", file.first_number + segment, file.segment_lines[i]);
  const auto after = std::ranges::upper_bound(file.parts, segment, {}, &DomainPart::first_segment);
  const DomainPart &part = *(after - 1);
  return fmt::format("segment {} (from {}[{}])", segment, part.place, segment - part.first_segment);
}

} // namespace dovetail
