// A PointTable into one file, every rank its own byte range.
#include "dovetail/io/points.hpp"

#include "dovetail/comm/agreement.hpp"
#include "dovetail/comm/collectives.hpp"
#include "dovetail/io/little_endian.hpp"
#include "dovetail/io/npy.hpp"
#include "dovetail/io/output_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>

namespace dovetail {
namespace {

PointFormat output_format(const PointTable &table, const std::string &path) {
  const std::optional<PointFormat> format = point_format_of(path);
  if (!format || *format == PointFormat::las)
    throw Error({ErrorKind::usage, path, "", "points cannot be written in this format",
                 "choose a name that ends in .npy or .f64"});
  for (std::size_t i = 0; i < table.attributes.size(); ++i)
    if (i > 0 || table.attributes[i].name != "z")
      throw Error({ErrorKind::usage, path, "",
                   fmt::format("the attribute '{}' has no place in a point file", table.attributes[i].name),
                   "write the points without it"});
  if (*format == PointFormat::f64 && !table.attributes.empty())
    throw Error({ErrorKind::usage, path, "", "the points have a z, and .f64 holds x and y only",
                 "choose a name that ends in .npy"});
  return *format;
}

// Local. This rank's records from `offset` on.
void write_records(OutputFile &file, const PointTable &table, std::int64_t offset,
                   std::int64_t buffer_bytes) {
  const std::vector<double> *z = table.attributes.empty() ? nullptr : &table.attributes.front().values;
  const std::size_t record_bytes = (z == nullptr ? 2 : 3) * sizeof(double);
  const std::size_t at_once = std::max<std::size_t>(1, static_cast<std::size_t>(buffer_bytes) / record_bytes);
  std::vector<std::byte> buffer(std::min(at_once, table.points.size()) * record_bytes);
  for (std::size_t first = 0; first < table.points.size(); first += at_once) {
    const std::size_t count = std::min(at_once, table.points.size() - first);
    for (std::size_t i = 0; i < count; ++i) {
      std::byte *record = buffer.data() + i * record_bytes;
      store_little(table.points[first + i].x, record);
      store_little(table.points[first + i].y, record + sizeof(double));
      if (z != nullptr)
        store_little((*z)[first + i], record + 2 * sizeof(double));
    }
    file.write_at(offset, std::span(buffer).first(count * record_bytes));
    offset += static_cast<std::int64_t>(count * record_bytes);
  }
}

} // namespace

void write_points(const Communicator &comm, const PointTable &table, const std::string &path,
                  const PointWriting &writing) {
  const PointFormat format = collectively(comm, [&] { return output_format(table, path); });
  const int columns = table.attributes.empty() ? 2 : 3;
  assert(columns == 2 || table.attributes.front().values.size() == table.points.size());

  const auto own = static_cast<GlobalIndex>(table.points.size());
  const GlobalIndex before = exclusive_scan(comm, own);
  const GlobalIndex total = all_reduce_sum(comm, own);
  const std::string header = format == PointFormat::npy ? npy_header(total, columns) : "";

  OutputFile file(comm, path);
  collectively(comm, [&] {
    if (comm.is_root() && !header.empty())
      file.write_at(0, std::as_bytes(std::span(header)));
    const auto record_bytes = static_cast<std::int64_t>(sizeof(double)) * columns;
    write_records(file, table, static_cast<std::int64_t>(header.size()) + before * record_bytes,
                  writing.buffer_bytes);
  });
  file.commit();
}

} // namespace dovetail
