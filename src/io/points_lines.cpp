// Lines of text into the columns of a PointTable.
#include "points_share.hpp"

#include "dovetail/io/text.hpp"

#include <algorithm>

namespace dovetail {
namespace {

// The lines of the pieces of a range.
LineReader reader_of(const InputFile &file, const PointFile &layout, RecordRange range,
                     std::int64_t buffer_bytes) {
  const std::int64_t begin = layout.first_byte + range.first * layout.record_bytes;
  return {file, layout.first_byte, begin, begin + range.count * layout.record_bytes, buffer_bytes};
}

// Row-major numbers into columns.
void append_rows(const std::vector<double> &numbers, const PointFile &layout, const FileColumns &columns) {
  if (numbers.empty())
    return;
  PointTable &table = columns.table();
  const auto fields = static_cast<std::size_t>(layout.fields);
  const std::size_t rows = numbers.size() / fields;
  const auto place = [&](std::size_t column) {
    return static_cast<std::size_t>(layout.columns[column].place);
  };
  const double *const x = numbers.data() + place(0), *const y = numbers.data() + place(1);
  for (std::size_t i = 0; i < rows; ++i)
    table.points.push_back({x[i * fields] + 0.0, y[i * fields] + 0.0}); // makes -0.0 to 0.0
  for (std::size_t column = 2; column < layout.columns.size(); ++column) {
    const double *const values = numbers.data() + place(column);
    std::vector<double> &into = columns.attribute(column);
    for (std::size_t i = 0; i < rows; ++i)
      into.push_back(values[i * fields] + 0.0);
  }
}

void follow_numbers(const std::vector<double> &numbers, std::size_t fields, LineCount &count) {
  if (count.lines == 0 && !numbers.empty())
    count.first_number = numbers.front();
  for (std::size_t i = 0; count.first_break < 0 && i < numbers.size(); i += fields) {
    const GlobalIndex line = count.lines + static_cast<GlobalIndex>(i / fields);
    if (numbers[i] == count.first_number + static_cast<double>(line))
      continue;
    count.first_break = line;
    count.number_there = numbers[i];
  }
}

} // namespace

void refuse_line(const InputFile &file, const PointFile &layout, RecordRange range, GlobalIndex record,
                 const std::string &what, const std::string &remedy) {
  constexpr std::int64_t buffer_bytes = std::int64_t{1} << 20;
  LineReader reader = reader_of(file, layout, range, buffer_bytes);
  while (reader.next()) {
    const GlobalIndex count = count_data_lines(reader.lines());
    if (record < count)
      refuse_text(file,
                  reader.offset() + static_cast<std::int64_t>(offset_of_data_line(reader.lines(), record)),
                  what, remedy);
    record -= count;
  }
  file.refuse(file.bytes(), what, remedy); // the file has changed
}

LineCount read_lines(const InputFile &file, const PointFile &layout, RecordRange range,
                     std::int64_t buffer_bytes, const FileColumns &columns, ProgressCount &done) {
  LineReader reader = reader_of(file, layout, range, buffer_bytes);
  const LineLayout lines = line_layout(layout);
  const auto fields = static_cast<std::size_t>(layout.fields);
  LineCount result;
  std::vector<double> numbers;
  while (reader.next()) {
    numbers.clear();
    try {
      parse_lines(reader.lines(), lines, numbers);
    } catch (const LineFault &fault) {
      refuse_text(file, reader.offset() + static_cast<std::int64_t>(fault.offset), fault.what, fault.remedy);
    }
    if (layout.format == PointFormat::node)
      follow_numbers(numbers, fields, result);
    append_rows(numbers, layout, columns);
    result.lines += static_cast<GlobalIndex>(numbers.size() / fields);
    done.add(static_cast<double>(reader.lines().size()) / static_cast<double>(layout.record_bytes));
  }
  for (GlobalIndex line = 0; line < result.lines; ++line)
    columns.table().input_index.push_back(line);
  columns.fill_up();
  return result;
}

} // namespace dovetail
