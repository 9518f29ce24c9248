// Point files into the columns of a PointTable, every rank its own range of records.
#include "points_share.hpp"

#include "dovetail/base/huge_pages.hpp"
#include "dovetail/comm/agreement.hpp"
#include "dovetail/comm/collectives.hpp"
#include "dovetail/comm/serialization.hpp"
#include "dovetail/io/text.hpp"

#include <boost/serialization/array.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <limits>

namespace boost::serialization {

template <class Archive> void serialize(Archive &archive, dovetail::LasHeader &las, unsigned) {
  archive &las.version_minor &las.point_format &las.scale &las.offset &las.lowest &las.highest;
}

template <class Archive> void serialize(Archive &archive, dovetail::PointColumn &column, unsigned) {
  archive &column.name &column.type &column.place;
}

template <class Archive> void serialize(Archive &archive, dovetail::PointFile &file, unsigned) {
  archive &file.path &file.format &file.file_bytes &file.first_byte &file.record_bytes &file.records;
  archive &file.by_columns &file.has_fields &file.columns &file.las &file.separator &file.fields &file.named;
  archive &file.coordinate_system;
}

} // namespace boost::serialization

namespace dovetail {
namespace {

// What a rank has read of one file. A text is numbered within the share until all lines are counted.
struct Share {
  std::size_t file;
  RecordRange range;
  std::size_t first_point, end_point; ///< in the table
  LineCount text;
};

// Of `total` things in a row, the first that belongs to this part: parts differ by one at most.
GlobalIndex first_of_part(GlobalIndex total, int part, int parts) {
  return total / parts * part + std::min<GlobalIndex>(part, total % parts);
}

InputFile open_same(const PointFile &layout) {
  InputFile file(layout.path);
  if (file.bytes() != layout.file_bytes)
    throw Error({ErrorKind::input, layout.path, "",
                 fmt::format("has {} bytes here and {} on the first rank", file.bytes(), layout.file_bytes),
                 "see that every machine has the same file, and that nobody is writing it"});
  return file;
}

LasClasses chosen_classes(const PointReading &reading) {
  LasClasses chosen;
  if (reading.classes.empty())
    chosen.set();
  for (const int number : reading.classes) {
    if (number < 0 || number >= static_cast<int>(chosen.size()))
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
      files.push_back(open_points(path));
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

// z first, then all that any file has.
std::vector<Attribute> all_attributes(const std::vector<PointFileCount> &files) {
  std::vector<Attribute> attributes;
  const auto add = [&](const std::string &name) {
    if (std::none_of(attributes.begin(), attributes.end(),
                     [&](const Attribute &a) { return a.name == name; }))
      attributes.push_back({name, {}});
  };
  if (std::any_of(files.begin(), files.end(), [](const PointFileCount &each) { return each.file.has("z"); }))
    add("z");
  for (const PointFileCount &each : files)
    for (std::size_t column = 2; column < each.file.columns.size(); ++column)
      add(each.file.columns[column].name);
  return attributes;
}

// Local. This rank's part of all files together.
std::vector<Share> read_shares(PointInput &input, const PointReading &reading, int rank, int ranks) {
  const LasClasses classes = chosen_classes(reading);
  GlobalIndex total = 0;
  for (const PointFileCount &each : input.files)
    total += shareable_records(each.file);
  const GlobalIndex begin = first_of_part(total, rank, ranks), end = first_of_part(total, rank + 1, ranks);

  PointTable &table = input.points;
  const auto expected = static_cast<std::size_t>(end - begin);
  reserve_huge(table.points, expected);
  reserve_huge(table.input_index, expected);
  for (Attribute &attribute : table.attributes)
    reserve_huge(attribute.values, expected);

  ProgressCount done(reading.progress, "read", static_cast<double>(end - begin));
  std::vector<Share> shares;
  GlobalIndex before = 0;
  for (std::size_t f = 0; f < input.files.size(); ++f) {
    PointFileCount &each = input.files[f];
    const GlobalIndex records = shareable_records(each.file);
    const GlobalIndex first = std::clamp<GlobalIndex>(begin - before, 0, records);
    const GlobalIndex last = std::clamp<GlobalIndex>(end - before, 0, records);
    before += records;
    if (first == last)
      continue;
    Share share{f, {first, last - first}, table.points.size(), 0, {}};
    const InputFile file = open_same(each.file);
    const FileColumns columns(table, each.file);
    if (each.file.is_text())
      share.text = read_lines(file, each.file, share.range, reading.buffer_bytes, columns, done);
    else
      read_records(file, each, share.range, reading.buffer_bytes, classes, columns, done);
    share.end_point = table.points.size();
    shares.push_back(share);
  }
  return shares;
}

// Of every file: how many lines lower ranks have read, and how many all.
struct LinesOfAll {
  std::vector<GlobalIndex> before, total;
};

// Collective.
LinesOfAll count_lines(const Communicator &comm, std::size_t files, const std::vector<Share> &shares) {
  std::vector<GlobalIndex> own(files);
  for (const Share &share : shares)
    own[share.file] = share.text.lines;
  return {exclusive_scan(comm, own), all_reduce_sum(comm, own)};
}

// Local. The vertices of a share count up from `due`.
void check_numbers(const PointFile &layout, const Share &share, GlobalIndex due) {
  const LineCount &text = share.text;
  const bool first_is_right = text.first_number == static_cast<double>(due);
  if (first_is_right && text.first_break < 0)
    return;
  const GlobalIndex line = first_is_right ? text.first_break : 0;
  refuse_line(InputFile(layout.path), layout, share.range, line,
              fmt::format("the vertex number is {}, and {} is due",
                          first_is_right ? text.number_there : text.first_number, due + line),
              "number the vertices one after the other, from 0 or from 1");
}

// Collective. Vertices must count up from 0 or 1 over all ranks, and be as many as promised.
void check_vertex_numbers(const Communicator &comm, const PointInput &input, const std::vector<Share> &shares,
                          const LinesOfAll &lines) {
  std::vector<double> first(input.files.size(), std::numeric_limits<double>::lowest());
  for (const Share &share : shares)
    if (lines.before[share.file] == 0 && share.text.lines > 0)
      first[share.file] = share.text.first_number;
  first = all_reduce_max(comm, first);
  collectively(comm, [&] {
    for (const Share &share : shares) {
      const PointFile &layout = input.files[share.file].file;
      if (layout.format != PointFormat::node || share.text.lines == 0)
        continue;
      const GlobalIndex before = lines.before[share.file];
      check_numbers(layout, share, before + (first[share.file] == 1 ? 1 : 0));
      if (before <= layout.records && before + share.text.lines > layout.records)
        refuse_line(
            InputFile(layout.path), layout, share.range, layout.records - before,
            fmt::format("the file goes on after the {} vertices that its header promises", layout.records),
            "correct the number of vertices in the first line");
    }
    // Said by the last rank, because the message of the lowest counts, and a vertex is missing somewhere.
    const bool last = comm.rank() + 1 == comm.size();
    for (std::size_t f = 0; last && f < input.files.size(); ++f) {
      const PointFile &layout = input.files[f].file;
      if (layout.format == PointFormat::node && lines.total[f] < layout.records)
        refuse_text(InputFile(layout.path), layout.file_bytes,
                    fmt::format("the file ends here, with {} of the {} vertices that its header promises",
                                lines.total[f], layout.records),
                    "copy or make the file again, or correct its first line");
    }
  });
}

// Collective. Numbers the points through all files.
void number_points(const Communicator &comm, PointInput &input, const std::vector<Share> &shares) {
  LinesOfAll lines;
  if (std::any_of(input.files.begin(), input.files.end(),
                  [](const PointFileCount &each) { return each.file.is_text(); })) {
    lines = count_lines(comm, input.files.size(), shares);
    check_vertex_numbers(comm, input, shares, lines);
  }
  for (std::size_t f = 0; f < input.files.size(); ++f) {
    PointFileCount &each = input.files[f];
    if (each.file.is_text())
      each.file.records = lines.total[f];
    each.first_index = input.records;
    input.records += each.file.records;
  }
  for (const Share &share : shares) {
    const PointFileCount &each = input.files[share.file];
    const GlobalIndex shift = each.first_index + (each.file.is_text() ? lines.before[share.file] : 0);
    for (std::size_t i = share.first_point; shift != 0 && i < share.end_point; ++i)
      input.points.input_index[i] += shift;
  }
}

// Collective.
void add_up_counts(const Communicator &comm, PointInput &input) {
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
  }
  for (const Attribute &attribute : input.points.attributes) {
    GlobalIndex without = 0;
    for (const PointFileCount &each : input.files)
      without += each.file.has(attribute.name) ? 0 : each.read;
    if (without > 0)
      input.absent.push_back({attribute.name, without});
  }
}

} // namespace

PointInput read_points(const Communicator &comm, std::span<const std::string> paths,
                       const PointReading &reading) {
  PointInput input;
  for (PointFile &file : read_headers(comm, paths, reading))
    input.files.push_back({std::move(file)});
  merge_coordinate_systems(input);
  input.points.attributes = all_attributes(input.files);
  const std::vector<Share> shares = collectively(
      comm, [] { return "the points that it reads"; },
      [&] { return read_shares(input, reading, comm.rank(), comm.size()); });
  number_points(comm, input, shares);
  add_up_counts(comm, input);
  return input;
}

} // namespace dovetail
