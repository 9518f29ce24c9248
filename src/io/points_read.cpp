// Point files into the columns of a PointTable, every rank its own range of records.
#include "points_share.hpp"

#include "dovetail/base/huge_pages.hpp"
#include "dovetail/comm/agreement.hpp"
#include "dovetail/comm/collectives.hpp"
#include "dovetail/comm/serialization.hpp"
#include "dovetail/io/point_stream.hpp"
#include "dovetail/io/text.hpp"

#include <boost/serialization/array.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <memory>
#include <random>
#include <utility>

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

// Where a rank is in its part of all files together, which it reads in pieces, each of one file.
class ShareReader {
public:
  ShareReader(const PointInput &input, int rank, int ranks) {
    GlobalIndex total = 0;
    for (const PointFileCount &each : input.files)
      total += shareable_records(each.file);
    next_ = first_of_part(total, rank, ranks);
    end_ = first_of_part(total, rank + 1, ranks);
  }

  GlobalIndex left() const { return end_ - next_; }

  // The next piece, behind what the table has; `input` gets the counts of what is skipped. Something is left.
  Share read(PointInput &input, GlobalIndex most, const PointReading &reading, const LasClasses &classes,
             PointTable &table, ProgressCount &done) {
    GlobalIndex records = shareable_records(input.files[file_].file);
    while (next_ >= before_ + records) {
      before_ += records;
      records = shareable_records(input.files[++file_].file);
    }
    PointFileCount &each = input.files[file_];
    const RecordRange range{next_ - before_, std::min({most, left(), before_ + records - next_})};
    Share share{file_, range, table.points.size(), 0, {}};
    const InputFile file = open_same(each.file);
    const FileColumns columns(table, each.file);
    if (each.file.is_text())
      share.text = read_lines(file, each.file, range, reading.buffer_bytes, columns, done);
    else
      read_records(file, each, range, reading.buffer_bytes, classes, columns, done);
    share.end_point = table.points.size();
    next_ += range.count;
    return share;
  }

private:
  std::size_t file_ = 0;
  GlobalIndex before_ = 0; // records of the files before this one
  GlobalIndex next_ = 0, end_ = 0;
};

// Local. This rank's part of all files together.
std::vector<Share> read_shares(PointInput &input, const PointReading &reading, int rank, int ranks) {
  const LasClasses classes = chosen_classes(reading);
  ShareReader reader(input, rank, ranks);
  PointTable &table = input.points;
  const auto expected = static_cast<std::size_t>(reader.left());
  reserve_huge(table.points, expected);
  reserve_huge(table.input_index, expected);
  for (Attribute &attribute : table.attributes)
    reserve_huge(attribute.values, expected);

  ProgressCount done(reading.progress, "read", static_cast<double>(reader.left()));
  std::vector<Share> shares;
  while (reader.left() > 0)
    shares.push_back(reader.read(input, reader.left(), reading, classes, table, done));
  return shares;
}

// How many lines come before each share in its file, and of every file how many it has.
struct LinesOfAll {
  std::vector<GlobalIndex> before, total;
};

// Collective.
LinesOfAll count_lines(const Communicator &comm, std::size_t files, const std::vector<Share> &shares) {
  std::vector<GlobalIndex> own(files);
  for (const Share &share : shares)
    own[share.file] += share.text.lines;
  std::vector<GlobalIndex> next = exclusive_scan(comm, own);
  LinesOfAll lines{{}, all_reduce_sum(comm, own)};
  for (const Share &share : shares)
    lines.before.push_back(std::exchange(next[share.file], next[share.file] + share.text.lines));
  return lines;
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
  for (std::size_t i = 0; i < shares.size(); ++i)
    if (lines.before[i] == 0 && shares[i].text.lines > 0)
      first[shares[i].file] = shares[i].text.first_number;
  first = all_reduce_max(comm, first);
  collectively(comm, [&] {
    for (std::size_t i = 0; i < shares.size(); ++i) {
      const Share &share = shares[i];
      const PointFile &layout = input.files[share.file].file;
      if (layout.format != PointFormat::node || share.text.lines == 0)
        continue;
      const GlobalIndex before = lines.before[i];
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

// Collective. Numbers the records through all files, and says for each share what its points' input indices
// are to grow by.
std::vector<GlobalIndex> number_shares(const Communicator &comm, PointInput &input,
                                       const std::vector<Share> &shares) {
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
  std::vector<GlobalIndex> shifts;
  for (std::size_t i = 0; i < shares.size(); ++i) {
    const PointFileCount &each = input.files[shares[i].file];
    shifts.push_back(each.first_index + (each.file.is_text() ? lines.before[i] : 0));
  }
  return shifts;
}

void shift_indices(PointTable &table, const Share &share, GlobalIndex shift) {
  for (std::size_t i = share.first_point; shift != 0 && i < share.end_point; ++i)
    table.input_index[i] += shift;
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

// Collective. What is known before any record is read.
PointInput open_input(const Communicator &comm, std::span<const std::string> paths,
                      const PointReading &reading) {
  PointInput input;
  for (PointFile &file : read_headers(comm, paths, reading))
    input.files.push_back({std::move(file)});
  merge_coordinate_systems(input);
  input.points.attributes = all_attributes(input.files);
  return input;
}

class FilesInPieces : public PointFiles {
public:
  FilesInPieces(const Communicator &comm, PointInput &&input, const PointReading &reading)
      : comm_(comm), input_(std::move(input)), reading_(reading), classes_(chosen_classes(reading)),
        reader_(input_, comm.rank(), comm.size()),
        done_(reading.progress, "read", 2 * static_cast<double>(reader_.left())) {
    for (const Attribute &attribute : input_.points.attributes)
      names_.push_back(attribute.name);
  }

  PointInput &input() override { return input_; }
  GlobalIndex estimated_points() const override {
    GlobalIndex points = 0;
    for (const PointFileCount &each : input_.files)
      points += each.file.records >= 0 ? each.file.records : shareable_records(each.file);
    return points;
  }
  const std::vector<std::string> &attribute_names() const override { return names_; }

  std::vector<Point> sample(std::size_t records) const override;

  bool next(std::size_t most, PointTable &table) override {
    table.points.clear();
    table.input_index.clear();
    for (Attribute &attribute : table.attributes)
      attribute.values.clear();
    if (reader_.left() == 0)
      return false;
    PointInput ignored; // counts, the second time
    if (again_)
      ignored.files = counts_;
    const Share share = reader_.read(again_ ? ignored : input_, static_cast<GlobalIndex>(most), reading_,
                                     classes_, table, done_);
    if (!again_)
      shares_.push_back(share);
    else
      shift_indices(table, share, shifts_[piece_++]);
    return true;
  }

  void begin_again() override {
    counts_ = input_.files; // texts as they were shared out
    shifts_ = number_shares(comm_, input_, shares_);
    add_up_counts(comm_, input_);
    PointInput same;
    same.files = counts_;
    reader_ = ShareReader(same, comm_.rank(), comm_.size());
    again_ = true;
  }

private:
  const Communicator &comm_;
  PointInput input_;
  PointReading reading_;
  LasClasses classes_;
  ShareReader reader_;
  ProgressCount done_;
  std::vector<std::string> names_;
  std::vector<Share> shares_;
  std::vector<PointFileCount> counts_;
  std::vector<GlobalIndex> shifts_;
  std::size_t piece_ = 0;
  bool again_ = false;
};

std::vector<Point> FilesInPieces::sample(std::size_t records) const {
  constexpr GlobalIndex together = 16; // in a place
  PointTable table;
  table.attributes = input_.points.attributes;
  GlobalIndex all = 0;
  for (const PointFileCount &each : input_.files)
    all += shareable_records(each.file);
  const GlobalIndex places = static_cast<GlobalIndex>(records) / together;
  ProgressCount nobody({}, "read", 1);
  for (PointFileCount each : input_.files) { // a copy, which counts what it skips
    const GlobalIndex share = shareable_records(each.file);
    const InputFile file = open_same(each.file);
    const FileColumns columns(table, each.file);
    const GlobalIndex of_file = std::max<GlobalIndex>(1, places * share / std::max<GlobalIndex>(1, all));
    GlobalIndex after = 0; // what has been read already
    for (GlobalIndex p = 0; p < of_file; ++p) {
      const GlobalIndex first = std::max(after, share / of_file * p);
      const RecordRange range{first, std::min(together, share - first)};
      if (range.count <= 0)
        break;
      if (each.file.is_text())
        read_lines(file, each.file, range, reading_.buffer_bytes, columns, nobody);
      else
        read_records(file, each, range, reading_.buffer_bytes, classes_, columns, nobody);
      after = range.first + range.count;
    }
  }
  std::ranges::sort(table.points, lexicographically_less);
  table.points.erase(std::unique(table.points.begin(), table.points.end()), table.points.end());
  std::shuffle(table.points.begin(), table.points.end(), std::mt19937_64(1)); // a part of it is a sample too
  return std::move(table.points);
}

} // namespace

std::unique_ptr<PointFiles> open_point_files(const Communicator &comm, std::span<const std::string> paths,
                                             const PointReading &reading) {
  PointInput input = open_input(comm, paths, reading);
  return collectively(comm, [&]() -> std::unique_ptr<PointFiles> {
    return std::make_unique<FilesInPieces>(comm, std::move(input), reading);
  });
}

PointInput read_points(const Communicator &comm, std::span<const std::string> paths,
                       const PointReading &reading) {
  PointInput input = open_input(comm, paths, reading);
  const std::vector<Share> shares = collectively(
      comm, [] { return "the points that it reads"; },
      [&] { return read_shares(input, reading, comm.rank(), comm.size()); });
  const std::vector<GlobalIndex> shifts = number_shares(comm, input, shares);
  for (std::size_t i = 0; i < shares.size(); ++i)
    shift_indices(input.points, shares[i], shifts[i]);
  add_up_counts(comm, input);
  return input;
}

} // namespace dovetail
