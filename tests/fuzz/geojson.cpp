#include "domain_readers.hpp"

using namespace dovetail;

int LLVMFuzzerTestOneInput(const std::uint8_t *data, std::size_t size) {
  return fuzz::check_domain(data, size, read_geojson);
}

std::vector<std::string> fuzz::seeds() {
  return {
      R"({"type":"Polygon","coordinates":[[[0,0],[4,0],[4,4],[0,0]],[[1,0.5],[2,0.5],[2,1],[1,0.5]]]})",
      std::string(R"({"type":"FeatureCollection","features":[{"type":"Feature","properties":{"marker":7},)") +
          R"("geometry":{"type":"LineString","coordinates":[[0,0,5],[1e3,-2.5]]}},{"type":"Feature","geometry":null}]})",
      std::string(R"({"type":"GeometryCollection","geometries":[{"type":"MultiPoint","coordinates":)") +
          R"([[1,2],[3,4]]},{"type":"MultiPolygon","coordinates":[[[[0,0],[1,0],[0,1]]]]}]})",
      R"({"type":"MultiLineString","coordinates":[[[0,0],[2,2]],[[0,2],[2,0]]]})",
      R"({"type":"Point","coordinates":[1,1e999]})",
      R"([[[[[[[[)",
      R"({"type":7})",
  };
}
