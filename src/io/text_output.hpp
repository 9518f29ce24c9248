/// Lines of whole numbers, written by many ranks into one file, where places are known only once the lengths
/// of all lines before are. Private to io.
#pragma once

#include "dovetail/comm/agreement.hpp"
#include "dovetail/comm/collectives.hpp"
#include "dovetail/io/output_file.hpp"

#include <array>
#include <bit>
#include <charconv>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace dovetail {

/// Takes text and keeps its length alone: a first pass that costs a fraction of making the text.
class TextLength {
public:
  void add(char) { ++bytes_; }
  void add(std::int64_t number) {
    bytes_ += number < 0 ? 1 + digits(static_cast<std::uint64_t>(-number))
                         : digits(static_cast<std::uint64_t>(number));
  }
  void end_line() { ++bytes_; }
  std::int64_t bytes() const { return bytes_; }

private:
  static constexpr std::array<std::uint64_t, 20> powers_of_ten = [] {
    std::array<std::uint64_t, 20> powers{};
    std::uint64_t power = 1;
    for (std::uint64_t &entry : powers) {
      entry = power;
      power *= 10;
    }
    return powers;
  }();

  static std::int64_t digits(std::uint64_t number) {
    // 1233 / 4096 is log10(2): at most one too small.
    const int guess = (static_cast<int>(std::bit_width(number | 1)) * 1233) >> 12;
    return guess + (number >= powers_of_ten[static_cast<std::size_t>(guess)] || guess == 0 ? 1 : 0);
  }

  std::int64_t bytes_ = 0;
};

/// Takes text into memory.
class TextBuffer {
public:
  void add(char c) {
    make_room();
    text_[used_++] = c;
  }
  void add(std::int64_t number) {
    make_room();
    char *const begin = text_.data() + used_;
    used_ += static_cast<std::size_t>(std::to_chars(begin, begin + longest_number, number).ptr - begin);
  }
  void end_line() { add('\n'); }

  std::int64_t bytes() const { return static_cast<std::int64_t>(used_); }
  void write(OutputFile &file, std::int64_t offset) const {
    file.write_at(offset, std::as_bytes(std::span(text_).first(used_)));
  }
  void clear() { used_ = 0; }

private:
  static constexpr std::size_t longest_number = 20;

  void make_room() {
    if (text_.size() - used_ < longest_number)
      text_.resize(2 * text_.size() + 4096);
  }

  std::vector<char> text_;
  std::size_t used_ = 0;
};

/// Takes text and writes it to a file from a given byte on, by whole lines, a buffer at a time.
class TextWriter {
public:
  TextWriter(OutputFile &file, std::int64_t offset, std::int64_t buffer_bytes)
      : file_(file), offset_(offset), buffer_bytes_(buffer_bytes) {}
  void add(char c) { buffer_.add(c); }
  void add(std::int64_t number) { buffer_.add(number); }
  void end_line() {
    buffer_.end_line();
    if (buffer_.bytes() >= buffer_bytes_)
      flush();
  }
  /// To be called at the end.
  void flush() {
    buffer_.write(file_, offset_);
    offset_ += buffer_.bytes();
    buffer_.clear();
  }

private:
  OutputFile &file_;
  std::int64_t offset_;
  std::int64_t buffer_bytes_;
  TextBuffer buffer_;
};

/// Collective. Every rank's lines of integers, one rank's after the other's, from byte `start` on.
/// lines(sink) is Local and puts them into a sink of any of the types above; it is called twice and must do
/// the same twice. progress: stage "write".
template <class Lines>
void write_lines(const Communicator &comm, OutputFile &file, std::int64_t start, std::int64_t buffer_bytes,
                 const Progress &progress, Lines &&lines) {
  TextLength length;
  lines(length);
  const std::int64_t offset = start + exclusive_scan(comm, length.bytes());
  ProgressCount count(progress, "write", static_cast<double>(length.bytes()));
  file.count_into(&count);
  collectively(comm, [&] {
    TextWriter writer(file, offset, buffer_bytes);
    lines(writer);
    writer.flush();
  });
  file.count_into(nullptr);
}

} // namespace dovetail
