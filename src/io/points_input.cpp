#include "points_input.hpp"

#include "dovetail/comm/agreement.hpp"
#include "dovetail/comm/collectives.hpp"
#include "dovetail/comm/serialization.hpp"

#include <boost/serialization/array.hpp>
#include <fmt/format.h>

#include <algorithm>
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

} // namespace

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

PointInput open_input(const Communicator &comm, std::span<const std::string> paths,
                      const PointReading &reading) {
  PointInput input;
  for (PointFile &file : read_headers(comm, paths, reading))
    input.files.push_back({std::move(file)});
  merge_coordinate_systems(input);
  input.points.attributes = all_attributes(input.files);
  return input;
}

} // namespace dovetail
