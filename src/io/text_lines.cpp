// The lines of a byte range of a file.
#include "dovetail/io/text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace dovetail {
namespace {

constexpr std::size_t longest_line = std::size_t{16} << 20;
constexpr std::size_t smallest_buffer = 16;

} // namespace

LineReader::LineReader(const InputFile &file, std::int64_t first_line, std::int64_t begin, std::int64_t end,
                       std::int64_t buffer_bytes)
    : file_(file), end_(std::min(end, file.bytes())), base_(std::max(begin - 1, first_line)),
      buffer_(std::max(smallest_buffer, static_cast<std::size_t>(buffer_bytes))),
      inside_line_(begin > first_line), done_(begin >= end_) {}

bool LineReader::next() {
  drop_given();
  // The byte before the range is read too: the range begins with a line if that is a newline.
  while (inside_line_ && !done_)
    skip_line();
  while (!done_) {
    fill();
    given_ = whole_lines();
    if (given_ > 0) {
      // The last byte of the range belongs to the last line that begins in it.
      done_ = base_ + static_cast<std::int64_t>(given_) >= end_;
      return true;
    }
    if (filled_ > longest_line)
      refuse_text(file_, base_, fmt::format("the line is longer than {} MiB", longest_line >> 20),
                  "see whether the file is text, with a newline behind every point");
    buffer_.resize(std::min(2 * buffer_.size(), longest_line + 2));
  }
  return false;
}

void LineReader::drop_given() {
  std::copy(buffer_.begin() + static_cast<std::ptrdiff_t>(given_),
            buffer_.begin() + static_cast<std::ptrdiff_t>(filled_), buffer_.begin());
  base_ += static_cast<std::int64_t>(given_);
  filled_ -= given_;
  given_ = 0;
}

void LineReader::skip_line() {
  fill();
  const std::size_t newline = std::string_view(buffer_.data(), filled_).find('\n');
  inside_line_ = newline == std::string_view::npos;
  given_ = inside_line_ ? filled_ : newline + 1;
  drop_given();
  done_ = base_ >= end_;
}

// One byte stays free for the newline that the last line may lack.
void LineReader::fill() {
  const std::int64_t rest =
      std::max<std::int64_t>(0, file_.bytes() - base_ - static_cast<std::int64_t>(filled_));
  const auto count = static_cast<std::size_t>(
      std::clamp<std::int64_t>(static_cast<std::int64_t>(buffer_.size() - filled_) - 1, 0, rest));
  file_.read_at(base_ + static_cast<std::int64_t>(filled_),
                std::as_writable_bytes(std::span(buffer_).subspan(filled_, count)));
  filled_ += count;
  if (static_cast<std::int64_t>(count) == rest && filled_ > 0 && buffer_[filled_ - 1] != '\n')
    buffer_[filled_++] = '\n';
}

std::size_t LineReader::whole_lines() const {
  const std::string_view text(buffer_.data(), filled_);
  const std::int64_t last_own_byte = end_ - 1 - base_;
  if (last_own_byte < static_cast<std::int64_t>(filled_)) {
    const std::size_t newline =
        text.find('\n', static_cast<std::size_t>(std::max<std::int64_t>(0, last_own_byte)));
    if (newline != std::string_view::npos)
      return newline + 1;
  }
  const std::size_t newline = text.rfind('\n');
  return newline == std::string_view::npos ? 0 : newline + 1;
}

void refuse_text(const InputFile &file, std::int64_t byte, const std::string &what,
                 const std::string &remedy) {
  constexpr std::int64_t at_once = std::int64_t{1} << 20;
  std::vector<char> buffer(static_cast<std::size_t>(std::min(at_once, byte)));
  std::int64_t line = 1, line_begin = 0;
  for (std::int64_t base = 0; base < byte; base += at_once) {
    const auto part = std::span(buffer).first(static_cast<std::size_t>(std::min(at_once, byte - base)));
    file.read_at(base, std::as_writable_bytes(part));
    line += std::count(part.begin(), part.end(), '\n');
    const auto newline = std::find(part.rbegin(), part.rend(), '\n');
    if (newline != part.rend())
      line_begin = base + (part.rend() - newline);
    if (base == 0 && std::string_view(part.data(), part.size()).starts_with("\xef\xbb\xbf") && line == 1)
      line_begin = 3;
  }
  throw Error({ErrorKind::input, file.path(),
               fmt::format("line {}, character {}", line, byte - line_begin + 1), what, remedy});
}

} // namespace dovetail
