#include "point_readers.hpp"

#include "io/points_share.hpp"
#include "io/points_write_text.hpp"

#include "dovetail/io/little_endian.hpp"
#include "dovetail/io/npy.hpp"

#include <bit>
#include <cmath>
#include <cstdint>
#include <optional>

namespace dovetail::fuzz {
namespace {

const std::string name = "a file";

struct Result {
  PointFileCount count;
  PointTable points;
  std::string refusal; // empty: read
};

PointTable table_for(const PointFile &layout) {
  PointTable table;
  for (std::size_t column = 2; column < layout.columns.size(); ++column)
    table.attributes.push_back({layout.columns[column].name, {}});
  return table;
}

// As so many ranks would, one after the other.
Result read(const InputFile &file, const PointFile &layout, int ranks, std::int64_t buffer_bytes) {
  Result result{{layout}, table_for(layout), {}};
  PointFileCount &count = result.count;
  const GlobalIndex total = shareable_records(layout);
  GlobalIndex lines = 0;
  ProgressCount nobody({}, "read", 1);
  try {
    for (int rank = 0; rank < ranks; ++rank) {
      const GlobalIndex begin = total / ranks * rank;
      const GlobalIndex end = rank + 1 < ranks ? total / ranks * (rank + 1) : total;
      if (begin == end)
        continue;
      const FileColumns columns(result.points, layout);
      const std::size_t before = result.points.points.size();
      if (layout.is_text()) {
        const LineCount read = read_lines(file, layout, {begin, end - begin}, buffer_bytes, columns, nobody);
        for (std::size_t i = before; i < result.points.points.size(); ++i)
          result.points.input_index[i] += lines;
        lines += read.lines;
      } else
        read_records(file, count, {begin, end - begin}, buffer_bytes, LasClasses().set(), columns, nobody);
    }
  } catch (const Error &error) {
    expect_helpful(error, name);
    result.refusal = error.what();
  }
  if (layout.is_text())
    count.file.records = lines;
  count.read = count.file.records - count.withheld - count.other_class;
  return result;
}

bool same(double a, double b) {
  return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b) ||
         (std::isnan(a) && std::isnan(b));
}

// But for names.
void expect_same(const PointTable &a, const PointTable &b, const char *what) {
  expect(a.points.size() == b.points.size() && a.attributes.size() == b.attributes.size(), what);
  for (std::size_t i = 0; i < a.points.size(); ++i)
    expect(same(a.points[i].x, b.points[i].x) && same(a.points[i].y, b.points[i].y), what);
  for (std::size_t k = 0; k < a.attributes.size(); ++k)
    for (std::size_t i = 0; i < a.points.size(); ++i)
      expect(same(a.attributes[k].values[i], b.attributes[k].values[i]), what);
}

void expect_sound(const Result &result) {
  const PointTable &table = result.points;
  const auto is_coordinate = [](double v) { return std::isfinite(v) && !(v == 0 && std::signbit(v)); };
  expect(static_cast<GlobalIndex>(table.points.size()) == result.count.read, "all records are accounted for");
  expect(table.input_index.size() == table.points.size(), "as many indices as points");
  for (std::size_t i = 0; i < table.points.size(); ++i) {
    expect(is_coordinate(table.points[i].x) && is_coordinate(table.points[i].y), "finite coordinates");
    expect(table.input_index[i] > (i == 0 ? -1 : table.input_index[i - 1]), "indices ascend");
    expect(table.input_index[i] < result.count.file.records, "indices are those of records");
  }
  for (const Attribute &attribute : table.attributes) {
    expect(attribute.values.size() == table.points.size(), "attributes as long as the points");
    expect(!attribute.name.empty(), "attributes have names");
    if (attribute.name == "z")
      for (const double value : attribute.values)
        expect(is_coordinate(value), "finite heights");
  }
}

Result read_again(const std::string &text, PointFormat format) {
  const InputFile file(name, std::as_bytes(std::span(text)));
  try {
    return read(file, read_header(file, format), 1, std::int64_t{1} << 16);
  } catch (const Error &error) {
    fail(std::string("what was written can be read: ") + error.what());
  }
}

void expect_round_trips(const PointTable &table) {
  TextStyle style;
  std::vector<std::string> names{"x", "y"};
  for (const Attribute &attribute : table.attributes) {
    style.attributes.push_back(&attribute.values);
    names.push_back(attribute.name);
  }
  style.separator = ',';
  std::string csv = line_of_names(table);
  append_lines(table, 0, table.points.size(), style, csv);
  expect_same(table, read_again(csv, PointFormat::text).points, ".csv keeps every bit");

  style.separator = ' ';
  style.numbered = true;
  std::string node =
      std::to_string(table.points.size()) + " 2 " + std::to_string(table.attributes.size()) + " 0\n";
  append_lines(table, 0, table.points.size(), style, node);
  expect_same(table, read_again(node, PointFormat::node).points, ".node keeps every bit");

  std::string npy = npy_records_header(static_cast<GlobalIndex>(table.points.size()), names);
  const auto add = [&npy](double value) {
    std::byte bytes[sizeof value];
    store_little(value, bytes);
    npy.append(reinterpret_cast<const char *>(bytes), sizeof value);
  };
  for (std::size_t i = 0; i < table.points.size(); ++i) {
    add(table.points[i].x);
    add(table.points[i].y);
    for (const Attribute &attribute : table.attributes)
      add(attribute.values[i]);
  }
  expect_same(table, read_again(npy, PointFormat::npy).points, ".npy keeps every bit");
}

} // namespace

void check_points(std::span<const std::byte> bytes, PointFormat format) {
  const InputFile file(name, bytes);
  std::optional<PointFile> layout;
  try {
    layout = read_header(file, format);
  } catch (const Error &error) {
    expect_helpful(error, name);
    return;
  }
  for (const std::string &line : description_lines(*layout))
    expect_printable(line);
  const Result whole = read(file, *layout, 1, std::int64_t{1} << 16);
  const Result parts = read(file, *layout, 3, 1);
  expect(whole.refusal == parts.refusal, "all numbers of ranks read, or refuse with the same words");
  if (!whole.refusal.empty())
    return;
  expect_sound(whole);
  expect_sound(parts);
  expect_same(whole.points, parts.points, "all numbers of ranks read the same");
  expect(whole.points.input_index == parts.points.input_index, "all numbers of ranks number alike");
  expect_round_trips(whole.points);
}

int check_points(const std::uint8_t *data, std::size_t size, PointFormat format) {
  check_points(std::as_bytes(std::span(data, size)), format);
  return 0;
}

} // namespace dovetail::fuzz
