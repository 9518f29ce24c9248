// Records of fixed size into the columns of a PointTable.
#include "points_share.hpp"

#include "dovetail/io/las.hpp"
#include "dovetail/io/little_endian.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace dovetail {
namespace {

constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

// Calls `work` with a zero of the type.
template <class Work> void with_type(NumberType type, Work &&work) {
  switch (type) {
  case NumberType::float64:
    return work(double{});
  case NumberType::float32:
    return work(float{});
  case NumberType::int8:
    return work(std::int8_t{});
  case NumberType::int16:
    return work(std::int16_t{});
  case NumberType::int32:
    return work(std::int32_t{});
  case NumberType::uint8:
    return work(std::uint8_t{});
  case NumberType::uint16:
    return work(std::uint16_t{});
  case NumberType::uint32:
    return work(std::uint32_t{});
  }
}

// A column of the records in the buffer.
struct Numbers {
  const std::byte *bytes;
  std::int64_t stride;
};

// x, y and z must be finite.
bool is_coordinate(const PointFile &file, std::size_t column) {
  return column < 2 || file.columns[column].name == "z";
}

[[noreturn]] void refuse_coordinate(const PointFile &file, GlobalIndex record, std::size_t column,
                                    double value) {
  const PointColumn &at = file.columns[column];
  const std::int64_t byte = file.by_columns
                                ? file.first_byte + at.place * file.records + record * bytes_of(at.type)
                                : file.first_byte + record * file.record_bytes + at.place;
  throw Error({ErrorKind::input, file.path, fmt::format("record {} (counted from 0), byte {}", record, byte),
               fmt::format("{} is {}", at.name, std::isnan(value) ? "NaN (not a number)" : "infinite"),
               "remove or repair that record"});
}

double value_at(const PointFile &file, std::size_t column, const Numbers &numbers, GlobalIndex i) {
  double value = 0;
  with_type(file.columns[column].type, [&](auto zero) {
    value = static_cast<double>(load_little<decltype(zero)>(numbers.bytes + i * numbers.stride));
  });
  return value;
}

[[noreturn]] void refuse_first_not_finite(const PointFile &file, RecordRange range,
                                          std::span<const Numbers> columns) {
  for (GlobalIndex i = 0;; ++i)
    for (std::size_t column = 0; column < columns.size(); ++column)
      if (const double value = value_at(file, column, columns[column], i);
          is_coordinate(file, column) && !std::isfinite(value))
        refuse_coordinate(file, range.first + i, column, value);
}

void decode_numbers(const PointFile &file, RecordRange range, std::span<const Numbers> from,
                    const FileColumns &columns) {
  PointTable &table = columns.table();
  const std::size_t before = table.points.size(), count = static_cast<std::size_t>(range.count);
  table.points.resize(before + count);
  bool finite = true;
  for (std::size_t column = 0; column < from.size(); ++column)
    with_type(file.columns[column].type, [&](auto zero) {
      const bool coordinate = is_coordinate(file, column);
      const auto decode_into = [&](auto &&slot) {
        const std::byte *number = from[column].bytes;
        for (std::size_t i = 0; i < count; ++i, number += from[column].stride) {
          const auto value = static_cast<double>(load_little<decltype(zero)>(number));
          finite = finite && (!coordinate || std::isfinite(value));
          slot(i) = value + 0.0; // makes -0.0 to 0.0
        }
      };
      Point *const points = table.points.data() + before;
      if (column == 0)
        decode_into([points](std::size_t i) -> double & { return points[i].x; });
      else if (column == 1)
        decode_into([points](std::size_t i) -> double & { return points[i].y; });
      else {
        std::vector<double> &attribute = columns.attribute(column);
        attribute.resize(before + count);
        decode_into([values = attribute.data() + before](std::size_t i) -> double & { return values[i]; });
      }
    });
  if (!finite)
    refuse_first_not_finite(file, range, from);
  for (GlobalIndex i = 0; i < range.count; ++i)
    table.input_index.push_back(range.first + i);
}

void decode_las(PointFileCount &input, RecordRange range, const std::byte *bytes, const LasClasses &classes,
                const FileColumns &columns) {
  const LasHeader &las = input.file.las;
  for (GlobalIndex i = 0; i < range.count; ++i) {
    const std::byte *record = bytes + i * input.file.record_bytes;
    const LasFlags flags = las_flags(record, las.point_format);
    if (flags.withheld) {
      ++input.withheld;
      continue;
    }
    if (!classes[static_cast<std::size_t>(flags.classification)]) {
      ++input.other_class;
      continue;
    }
    std::array<double, 3> values;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      // One rounded product and one rounded sum, as every reader of LAS has it.
      values[axis] = load_little<std::int32_t>(record + 4 * axis) * las.scale[axis] + las.offset[axis];
      if (!std::isfinite(values[axis]))
        refuse_coordinate(input.file, range.first + i, axis, values[axis]);
      values[axis] += 0.0; // makes -0.0 to 0.0
    }
    columns.table().points.push_back({values[0], values[1]});
    columns.table().input_index.push_back(range.first + i);
    columns.attribute(2).push_back(values[2]);
  }
}

// The records of a range, or the pieces of all columns that belong to it, into the buffer.
std::vector<Numbers> load(const InputFile &file, const PointFile &layout, RecordRange range,
                          std::span<std::byte> buffer) {
  std::vector<Numbers> numbers;
  if (!layout.by_columns) {
    const auto size = static_cast<std::size_t>(range.count * layout.record_bytes);
    file.read_at(layout.first_byte + range.first * layout.record_bytes, buffer.first(size));
    for (const PointColumn &column : layout.columns)
      numbers.push_back({buffer.data() + column.place, layout.record_bytes});
    return numbers;
  }
  for (const PointColumn &column : layout.columns) {
    const std::int64_t number_bytes = bytes_of(column.type);
    const auto size = static_cast<std::size_t>(range.count * number_bytes);
    file.read_at(layout.first_byte + column.place * layout.records + range.first * number_bytes,
                 buffer.first(size));
    numbers.push_back({buffer.data(), number_bytes});
    buffer = buffer.subspan(size);
  }
  return numbers;
}

} // namespace

FileColumns::FileColumns(PointTable &table, const PointFile &file) : table_(table) {
  for (std::size_t column = 2; column < file.columns.size(); ++column)
    for (Attribute &attribute : table.attributes)
      if (attribute.name == file.columns[column].name)
        into_.push_back(&attribute.values);
  for (Attribute &attribute : table.attributes)
    if (!file.has(attribute.name))
      absent_.push_back({&attribute.values, attribute.name == "z" ? 0.0 : not_a_number});
}

void FileColumns::fill_up() const {
  for (const Absent &absent : absent_)
    absent.values->resize(table_.points.size(), absent.value);
}

void read_records(const InputFile &file, PointFileCount &input, RecordRange range, std::int64_t buffer_bytes,
                  const LasClasses &classes, const FileColumns &columns, ProgressCount &done) {
  const PointFile &layout = input.file;
  const GlobalIndex at_once = std::clamp<GlobalIndex>(buffer_bytes / layout.record_bytes, 1, range.count);
  std::vector<std::byte> buffer(static_cast<std::size_t>(at_once * layout.record_bytes));
  const GlobalIndex end = range.first + range.count;
  for (GlobalIndex first = range.first; first < end; first += at_once) {
    const RecordRange part{first, std::min(at_once, end - first)};
    const std::vector<Numbers> numbers = load(file, layout, part, buffer);
    if (layout.format == PointFormat::las)
      decode_las(input, part, buffer.data(), classes, columns);
    else
      decode_numbers(layout, part, numbers, columns);
    done.add(static_cast<double>(part.count));
  }
  columns.fill_up();
}

} // namespace dovetail
