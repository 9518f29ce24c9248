// A PointTable into one file, every rank its own byte range.
#include "points_share.hpp"
#include "points_write_text.hpp"

#include "dovetail/comm/agreement.hpp"
#include "dovetail/comm/collectives.hpp"
#include "dovetail/io/little_endian.hpp"
#include "dovetail/io/npy.hpp"
#include "dovetail/io/output_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <utility>

namespace dovetail {
namespace {

PointFormat output_format(const PointTable &table, const std::string &path) {
  const std::optional<PointFormat> format = point_format_of(path);
  if (!format || *format == PointFormat::las)
    throw Error({ErrorKind::usage, path, "", "points cannot be written in this format",
                 "choose a name that ends in one of " + known_point_extensions(true)});
  if (*format == PointFormat::f64 && !table.attributes.empty())
    throw Error({ErrorKind::usage, path, "",
                 fmt::format("the points have an attribute {}, and .f64 holds x and y only",
                             table.attributes[0].name),
                 "choose a name that ends in .npy or .csv"});
  return *format;
}

bool has_z_at_most(const PointTable &table) {
  return table.attributes.empty() || (table.attributes.size() == 1 && table.attributes[0].name == "z");
}

std::vector<std::string> names_of_columns(const PointTable &table) {
  std::vector<std::string> names{"x", "y"};
  for (const Attribute &attribute : table.attributes)
    names.push_back(attribute.name);
  return names;
}

// Local. This rank's records from `offset` on.
void write_records(OutputFile &file, const PointTable &table, std::int64_t offset,
                   std::int64_t buffer_bytes) {
  const std::size_t columns = 2 + table.attributes.size(), record_bytes = columns * sizeof(double);
  const std::size_t at_once = std::max<std::size_t>(1, static_cast<std::size_t>(buffer_bytes) / record_bytes);
  std::vector<std::byte> buffer(std::min(at_once, table.points.size()) * record_bytes);
  for (std::size_t first = 0; first < table.points.size(); first += at_once) {
    const std::size_t count = std::min(at_once, table.points.size() - first);
    std::byte *number = buffer.data();
    const auto add = [&number](double value) {
      store_little(value, number);
      number += sizeof(double);
    };
    for (std::size_t i = first; i < first + count; ++i) {
      add(table.points[i].x);
      add(table.points[i].y);
      for (const Attribute &attribute : table.attributes)
        add(attribute.values[i]);
    }
    file.write_at(offset, std::span(buffer).first(count * record_bytes));
    offset += static_cast<std::int64_t>(count * record_bytes);
  }
}

// Lines of text, whose length is known only when they are made: as many as memory is granted for are kept
// from measuring them, the others are made twice.
class Lines {
public:
  Lines(const PointTable &table, const TextStyle &style, const PointWriting &writing)
      : table_(table), style_(style), writing_(writing) {}

  // Local. The bytes of all lines.
  std::int64_t measure() {
    std::int64_t bytes = 0;
    bool keeping = true;
    ProgressCount made(part_of_stage(writing_.progress, 0, usual_share_of_making), "write",
                       static_cast<double>(table_.points.size()));
    std::size_t before = 0;
    for_blocks(0, [&](std::size_t end, const std::string &block) {
      made.add(static_cast<double>(end - std::exchange(before, end)));
      bytes += static_cast<std::int64_t>(block.size());
      keeping = keeping && bytes <= writing_.kept_bytes;
      if (!keeping)
        return;
      if (kept_.empty())
        kept_.reserve(static_cast<std::size_t>(std::min(
            writing_.kept_bytes, bytes * static_cast<std::int64_t>(table_.points.size() / end + 1))));
      kept_ += block;
      kept_lines_ = end;
    });
    return bytes;
  }

  // Local. measured: what measure() has returned, or 0 if it was not called.
  void write(OutputFile &file, std::int64_t offset, std::int64_t measured) const {
    ProgressCount written(part_of_stage(writing_.progress, measured > 0 ? usual_share_of_making : 0, 1),
                          "write", static_cast<double>(table_.points.size()));
    const auto write_block = [&](std::string_view block) {
      file.write_at(offset, std::as_bytes(std::span(block)));
      offset += static_cast<std::int64_t>(block.size());
    };
    const auto step = static_cast<std::size_t>(std::max<std::int64_t>(1, writing_.buffer_bytes));
    for (std::size_t begin = 0; begin < kept_.size(); begin += step) {
      const std::string_view block = std::string_view(kept_).substr(begin, step);
      write_block(block);
      written.add(static_cast<double>(kept_lines_) * static_cast<double>(block.size()) /
                  static_cast<double>(kept_.size()));
    }
    std::size_t before = kept_lines_;
    for_blocks(kept_lines_, [&](std::size_t end, const std::string &block) {
      write_block(block);
      written.add(static_cast<double>(end - std::exchange(before, end)));
    });
  }

private:
  // Lines that are kept have only to be written after they have been made.
  static constexpr double usual_share_of_making = 0.7;

  // A line is written whole, so a block is at least one.
  template <class Work> void for_blocks(std::size_t first, Work &&work) const {
    const std::size_t columns = 4 + style_.attributes.size();
    constexpr std::size_t bytes_of_number = 24;
    const std::size_t at_once = std::max<std::size_t>(1, static_cast<std::size_t>(writing_.buffer_bytes) /
                                                             (columns * bytes_of_number));
    std::string block;
    for (; first < table_.points.size(); first += at_once) {
      const std::size_t count = std::min(at_once, table_.points.size() - first);
      block.clear();
      append_lines(table_, first, count, style_, block);
      work(first + count, block);
    }
  }

  const PointTable &table_;
  const TextStyle &style_;
  const PointWriting &writing_;
  std::string kept_;
  std::size_t kept_lines_ = 0;
};

// Collective.
void write_lines(const Communicator &comm, OutputFile &file, const PointTable &table, const TextStyle &style,
                 std::int64_t header_bytes, const PointWriting &writing) {
  Lines lines(table, style, writing);
  // One rank has nobody to tell. Several all measure, also the last: it would only begin later.
  const std::int64_t own = collectively(comm, [&] { return comm.size() == 1 ? 0 : lines.measure(); });
  const std::int64_t offset = header_bytes + exclusive_scan(comm, own);
  collectively(comm, [&] { lines.write(file, offset, own); });
}

// Collective. Triangle's vertices have a marker if all ranks have whole numbers of that name.
TextStyle style_of(const Communicator &comm, const PointTable &table, const std::string &path,
                   PointFormat format, GlobalIndex before) {
  TextStyle style;
  style.separator = extension_of(path) == ".csv" ? ',' : ' ';
  style.numbered = format == PointFormat::node;
  style.first_number = before;
  for (const Attribute &attribute : table.attributes) {
    const bool marker = style.numbered && style.marker == nullptr && attribute.name == "marker" &&
                        all_of_ranks(comm, are_whole(attribute.values));
    if (marker)
      style.marker = &attribute.values;
    else
      style.attributes.push_back(&attribute.values);
  }
  return style;
}

} // namespace

void write_points(const Communicator &comm, const PointTable &table, const std::string &path,
                  const PointWriting &writing) {
  const PointFormat format = collectively(comm, [&] { return output_format(table, path); });
  for ([[maybe_unused]] const Attribute &attribute : table.attributes)
    assert(attribute.values.size() == table.points.size());

  const auto own = static_cast<GlobalIndex>(table.points.size());
  const GlobalIndex before = exclusive_scan(comm, own);
  const GlobalIndex total = all_reduce_sum(comm, own);
  const int columns = 2 + static_cast<int>(table.attributes.size());
  const TextStyle style = style_of(comm, table, path, format, before);
  std::string header;
  if (format == PointFormat::npy && has_z_at_most(table))
    header = npy_header(total, columns);
  else if (format == PointFormat::npy)
    header = npy_records_header(total, names_of_columns(table));
  else if (format == PointFormat::node)
    header = fmt::format("{} 2 {} {}\n", total, style.attributes.size(), style.marker == nullptr ? 0 : 1);
  else if (format == PointFormat::text && style.separator == ',')
    header = line_of_names(table);

  OutputFile file(comm, path);
  const auto record_bytes = static_cast<std::int64_t>(sizeof(double)) * columns;
  ProgressCount written(writing.progress, "write", static_cast<double>(own * record_bytes));
  const auto header_bytes = static_cast<std::int64_t>(header.size());
  collectively(comm, [&] {
    if (comm.is_root() && !header.empty())
      file.write_at(0, std::as_bytes(std::span(header)));
    if (format != PointFormat::npy && format != PointFormat::f64)
      return;
    file.count_into(&written);
    write_records(file, table, header_bytes + before * record_bytes, writing.buffer_bytes);
  });
  if (format == PointFormat::text || format == PointFormat::node)
    write_lines(comm, file, table, style, header_bytes, writing);
  file.commit();
}

} // namespace dovetail
