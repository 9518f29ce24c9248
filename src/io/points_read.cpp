// Point files into the columns of a PointTable, every rank its own range of records.
#include "dovetail/io/points.hpp"

#include "dovetail/base/huge_pages.hpp"
#include "dovetail/comm/agreement.hpp"
#include "dovetail/comm/collectives.hpp"
#include "dovetail/comm/serialization.hpp"
#include "dovetail/io/input_file.hpp"
#include "dovetail/io/las.hpp"
#include "dovetail/io/little_endian.hpp"

#include <boost/serialization/array.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <bitset>
#include <cmath>
#include <numeric>

namespace boost::serialization {

template <class Archive> void serialize(Archive &archive, dovetail::LasHeader &las, unsigned) {
  archive &las.version_minor &las.point_format &las.scale &las.offset &las.lowest &las.highest;
}

template <class Archive> void serialize(Archive &archive, dovetail::PointFile &file, unsigned) {
  archive &file.path &file.format &file.file_bytes &file.first_byte &file.record_bytes &file.records;
  archive &file.columns &file.number_bytes &file.by_columns &file.las &file.coordinate_system;
}

} // namespace boost::serialization

namespace dovetail {
namespace {

constexpr std::size_t class_count = 256;

// Records first .. first + count - 1 of a file.
struct RecordRange {
  GlobalIndex first, count;
};

// Where the coordinates of a range are in memory.
struct Coordinates {
  const std::byte *bytes;
  std::int64_t record_stride, column_stride;
};

// Of `total` things in a row, the first that belongs to this part: parts differ by one at most.
GlobalIndex first_of_part(GlobalIndex total, int part, int parts) {
  return total / parts * part + std::min<GlobalIndex>(part, total % parts);
}

[[noreturn]] void refuse_coordinate(const PointFile &file, GlobalIndex record,
                                    const std::array<double, 3> &values) {
  const auto bad = std::find_if(values.begin(), values.end(), [](double v) { return !std::isfinite(v); });
  const auto column = bad - values.begin();
  const std::int64_t byte = file.by_columns
                                ? file.first_byte + (column * file.records + record) * file.number_bytes
                                : file.first_byte + record * file.record_bytes + column * file.number_bytes;
  throw Error({ErrorKind::input, file.path, fmt::format("record {} (counted from 0), byte {}", record, byte),
               fmt::format("{} is {}", "xyz"[column], std::isnan(*bad) ? "NaN (not a number)" : "infinite"),
               "remove or repair that record"});
}

// Fills the columns of the table, which all have the same length.
class Columns {
public:
  Columns(PointTable &table, bool with_z, GlobalIndex expected) : table_(table) {
    const auto size = static_cast<std::size_t>(expected);
    reserve_huge(table_.points, size);
    reserve_huge(table_.input_index, size);
    if (!with_z)
      return;
    table_.attributes.push_back({"z", {}});
    z_ = &table_.attributes.back().values;
    reserve_huge(*z_, size);
  }

  void append(const PointFile &file, GlobalIndex record, GlobalIndex first_index, double x, double y,
              double z) {
    if (!std::isfinite(x) || !std::isfinite(y) || !std::isfinite(z))
      refuse_coordinate(file, record, {x, y, z});
    table_.points.push_back({x + 0.0, y + 0.0}); // makes -0.0 to 0.0
    table_.input_index.push_back(first_index + record);
    if (z_ != nullptr)
      z_->push_back(z + 0.0);
  }

private:
  PointTable &table_;
  std::vector<double> *z_ = nullptr;
};

template <class Number>
void decode_numbers(const PointFileCount &input, RecordRange range, Coordinates from, Columns &columns) {
  const auto coordinate = [&](GlobalIndex i, int column) {
    return static_cast<double>(
        load_little<Number>(from.bytes + i * from.record_stride + column * from.column_stride));
  };
  const bool with_z = input.file.columns == 3;
  for (GlobalIndex i = 0; i < range.count; ++i)
    columns.append(input.file, range.first + i, input.first_index, coordinate(i, 0), coordinate(i, 1),
                   with_z ? coordinate(i, 2) : 0.0);
}

void decode_las(PointFileCount &input, RecordRange range, const std::byte *bytes,
                const std::bitset<class_count> &classes, Columns &columns) {
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
    // One rounded product and one rounded sum, as every reader of LAS has it.
    const auto coordinate = [&](std::size_t axis) {
      return load_little<std::int32_t>(record + 4 * axis) * las.scale[axis] + las.offset[axis];
    };
    columns.append(input.file, range.first + i, input.first_index, coordinate(0), coordinate(1),
                   coordinate(2));
  }
}

// Coordinate columns of their own, or records, into the buffer.
Coordinates load(const InputFile &file, const PointFile &layout, RecordRange range,
                 std::span<std::byte> buffer) {
  if (!layout.by_columns) {
    const auto size = static_cast<std::size_t>(range.count * layout.record_bytes);
    file.read_at(layout.first_byte + range.first * layout.record_bytes, buffer.first(size));
    return {buffer.data(), layout.record_bytes, layout.number_bytes};
  }
  const std::int64_t column_bytes = range.count * layout.number_bytes;
  for (std::int64_t column = 0; column < layout.columns; ++column)
    file.read_at(layout.first_byte + (column * layout.records + range.first) * layout.number_bytes,
                 buffer.subspan(static_cast<std::size_t>(column * column_bytes),
                                static_cast<std::size_t>(column_bytes)));
  return {buffer.data(), layout.number_bytes, column_bytes};
}

// Local. The range through a buffer of bounded size.
void read_range(PointFileCount &input, RecordRange range, const PointReading &reading,
                const std::bitset<class_count> &classes, Columns &columns) {
  const PointFile &layout = input.file;
  const InputFile file(layout.path);
  if (file.bytes() != layout.file_bytes)
    throw Error({ErrorKind::input, layout.path, "",
                 fmt::format("has {} bytes here and {} on the first rank", file.bytes(), layout.file_bytes),
                 "see that every machine has the same file, and that nobody is writing it"});
  const GlobalIndex records_at_once =
      std::clamp<GlobalIndex>(reading.buffer_bytes / layout.record_bytes, 1, range.count);
  std::vector<std::byte> buffer(static_cast<std::size_t>(records_at_once * layout.record_bytes));
  const GlobalIndex end = range.first + range.count;
  for (GlobalIndex first = range.first; first < end; first += records_at_once) {
    const RecordRange part{first, std::min(records_at_once, end - first)};
    const Coordinates from = load(file, layout, part, buffer);
    if (layout.format == PointFormat::las)
      decode_las(input, part, from.bytes, classes, columns);
    else if (layout.number_bytes == 4)
      decode_numbers<float>(input, part, from, columns);
    else
      decode_numbers<double>(input, part, from, columns);
  }
}

std::bitset<class_count> chosen_classes(const PointReading &reading) {
  std::bitset<class_count> chosen;
  if (reading.classes.empty())
    chosen.set();
  for (const int number : reading.classes) {
    if (number < 0 || number >= static_cast<int>(class_count))
      throw Error({ErrorKind::usage, "--class", "", fmt::format("{} is not a class", number),
                   "classes go from 0 to 255"});
    chosen.set(static_cast<std::size_t>(number));
  }
  return chosen;
}

// Collective. The headers, read once and sent round: a thousand ranks that open a thousand files each
// would keep the file system busy for minutes.
std::vector<PointFile> read_headers(const Communicator &comm, std::span<const std::string> paths,
                                    const PointReading &reading) {
  std::vector<PointFile> files;
  collectively(comm, [&] {
    if (!comm.is_root())
      return;
    for (const std::string &path : paths) {
      files.push_back(describe_points(path));
      if (!reading.classes.empty() && files.back().format != PointFormat::las)
        throw Error(
            {ErrorKind::usage, path, "", "only LAS points have a class", "leave out --class or this file"});
    }
  });
  broadcast(comm, files);
  return files;
}

void merge_coordinate_systems(PointInput &input) {
  const std::vector<CoordinateSystemRecord> *known = nullptr;
  for (const PointFileCount &each : input.files) {
    const auto &records = each.file.coordinate_system;
    if (records.empty())
      continue;
    if (known != nullptr && *known != records)
      input.mixed_coordinate_systems = true;
    known = &records;
    for (const CoordinateSystemRecord &record : records)
      if (std::find(input.coordinate_system.begin(), input.coordinate_system.end(), record) ==
          input.coordinate_system.end())
        input.coordinate_system.push_back(record);
  }
}

// Collective.
void add_up_counts(const Communicator &comm, PointInput &input, bool with_z) {
  std::vector<GlobalIndex> counts;
  for (const PointFileCount &each : input.files) {
    counts.push_back(each.withheld);
    counts.push_back(each.other_class);
  }
  counts = all_reduce_sum(comm, counts);
  auto count = counts.begin();
  for (PointFileCount &each : input.files) {
    each.withheld = *count++;
    each.other_class = *count++;
    each.read = each.file.records - each.withheld - each.other_class;
    input.read += each.read;
    input.withheld += each.withheld;
    input.other_class += each.other_class;
    if (with_z && each.file.columns < 3)
      input.without_z += each.read;
  }
}

} // namespace

PointInput read_points(const Communicator &comm, std::span<const std::string> paths,
                       const PointReading &reading) {
  PointInput input;
  bool with_z = false;
  for (PointFile &file : read_headers(comm, paths, reading)) {
    with_z = with_z || file.columns == 3;
    const GlobalIndex records = file.records;
    input.files.push_back({std::move(file), input.records});
    input.records += records;
  }
  merge_coordinate_systems(input);

  collectively(comm, [&] {
    const std::bitset<class_count> classes = chosen_classes(reading);
    const GlobalIndex begin = first_of_part(input.records, comm.rank(), comm.size());
    const GlobalIndex end = first_of_part(input.records, comm.rank() + 1, comm.size());
    Columns columns(input.points, with_z, end - begin);
    for (PointFileCount &each : input.files) {
      const GlobalIndex first = std::max(begin, each.first_index) - each.first_index;
      const GlobalIndex last = std::min(end, each.first_index + each.file.records) - each.first_index;
      if (first < last)
        read_range(each, {first, last - first}, reading, classes, columns);
    }
  });
  add_up_counts(comm, input, with_z);
  return input;
}

} // namespace dovetail
