#include "picture_layout.hpp"

#include "picture_font.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace dovetail::picture {
namespace {

constexpr int narrowest_with_text = 280;
constexpr int letters_across = 88; // at least, so that titles and legends fit

int text_width(const std::string &text, int dot) {
  return static_cast<int>(text.size()) * letter_advance * dot - dot;
}

/// The map as wide as the picture without its margins, and as high as the window asks, within reason.
View view_of(const Window &window, Box room) {
  const double across = window.x1 - window.x0;
  const double up = window.y1 - window.y0;
  double scale = across > 0 ? room.width / across : room.width / std::max(up, 1e-300);
  const double tallest = 1.25 * room.width;
  if (up * scale > tallest)
    scale = tallest / up;
  room.height = std::max(static_cast<int>(std::ceil(up * scale - 1e-6)), std::max(1, room.width / 8));
  return {window, room, scale};
}

/// Lays out one line of the legend after another.
class Legend {
public:
  Legend(Layout &layout, Box room) : layout_(layout), room_(room), y_(room.y) {}

  /// A box of colour and its text in a grid of columns.
  void entry(Colour colour, int swatch_height, const std::string &text) {
    const int dot = layout_.dot;
    const int letter = 7 * dot;
    const int width = 2 * letter + 4 * dot + text_width(text, dot) + 3 * letter;
    if (x_ > 0 && x_ + width - 3 * letter > room_.width)
      next_line();
    layout_.swatches.push_back(
        {{room_.x + x_, y_ + (letter - swatch_height) / 2, 2 * letter, swatch_height}, colour});
    layout_.texts.push_back({room_.x + x_ + 2 * letter + 4 * dot, y_, text});
    x_ += width;
  }
  /// A line of text alone.
  void remark(const std::string &text) {
    next_line();
    layout_.texts.push_back({room_.x, y_, text});
    y_ += 12 * layout_.dot;
  }
  void next_line() {
    if (x_ > 0)
      y_ += 12 * layout_.dot;
    x_ = 0;
  }

  void scale(const Meaning &meaning) {
    const int dot = layout_.dot;
    remark(meaning.name);
    const Box bar{room_.x, y_, room_.width, 9 * dot};
    for (int x = 0; x < bar.width; ++x)
      layout_.swatches.push_back({{bar.x + x, bar.y, 1, bar.height}, colour_at((x + 0.5) / bar.width)});
    int free = room_.x;
    const std::vector<double> ticks = ticks_of(meaning.scale);
    for (const double tick : ticks) {
      const std::string text =
          meaning.scale.logarithmic ? fmt::format("{:.6g}", tick) : number_text(tick, ticks[1] - ticks[0]);
      const int x = bar.x + static_cast<int>(meaning.scale.position(tick) * (bar.width - 1));
      const int begin = std::clamp(x - text_width(text, dot) / 2, room_.x,
                                   std::max(room_.x, room_.x + room_.width - text_width(text, dot)));
      if (begin < free)
        continue;
      layout_.swatches.push_back({{x, bar.y + bar.height, std::max(1, dot / 2), 3 * dot}, text_colour});
      layout_.texts.push_back({begin, bar.y + bar.height + 4 * dot, text});
      free = begin + text_width(text, dot) + 2 * letter_advance * dot;
    }
    y_ += bar.height + 16 * dot;
  }

  int end() {
    next_line();
    return y_;
  }

private:
  Layout &layout_;
  Box room_;
  int x_ = 0;
  int y_;
};

// Neighbours differ in lightness as well as in hue, so they are told apart without one of the receptors.
constexpr std::array<Colour, 6> slab_colours{
    {{98, 155, 205}, {242, 218, 120}, {72, 160, 140}, {248, 180, 170}, {110, 110, 170}, {200, 215, 225}}};

void add_slabs(Legend &legend, const std::vector<GlobalIndex> &sites, int dot) {
  const std::size_t named = std::min(sites.size(), slab_colours.size());
  for (std::size_t s = 0; s < named; ++s)
    legend.entry(colour_of_slab(static_cast<int>(s)), 7 * dot,
                 fmt::format("slab {}: {}", s, counted(sites[s], "site")));
  if (named < sites.size())
    legend.remark(counted(static_cast<GlobalIndex>(sites.size() - named), "more slab") +
                  " in the same colours again");
  legend.next_line();
}

void draw_text(const Layout &layout, const Text &text, int first_row, int rows, std::vector<Colour> &pixels) {
  const int dot = layout.dot;
  const int begin = std::max(first_row, text.y - dot);
  const int end = std::min(first_row + rows, text.y + (glyph_height + 1) * dot);
  if (begin >= end)
    return;
  PixelBand band(begin, end - begin, 0, layout.width);
  int left = text.x;
  for (const char letter : text.text) {
    for_each_stroke(letter, [&](Dot from, Dot to) {
      const auto middle = [&](Dot at) {
        return Point{left + (at.column + 0.5) * dot, text.y + (at.row + 0.5) * dot};
      };
      draw_segment(band, middle(from), middle(to), 0.5 * dot, LineLayer::paths);
    });
    left += letter_advance * dot;
  }
  const std::array<Ink, line_layers> inks{{{paper, 0}, {paper, 0}, {paper, 0}, {text_colour, 255}}};
  for (int row = begin; row < end; ++row)
    for (int column = 0; column < layout.width; ++column)
      if (const PixelSum &sum = band.row(row)[column]; !sum.is_empty())
        pixels[static_cast<std::size_t>(row - first_row) * static_cast<std::size_t>(layout.width) +
               static_cast<std::size_t>(column)] = resolve(sum, paper, inks);
}

} // namespace

std::string counted(GlobalIndex number, const char *name) {
  std::string digits = std::to_string(number);
  for (std::size_t end = digits.size(); end > 3;) {
    end -= 3;
    digits.insert(end, 1, ',');
  }
  return fmt::format("{} {}{}", digits, name, number == 1 ? "" : "s");
}

std::string number_text(double number, double step) {
  constexpr double largest = 1e12;
  constexpr int most_decimals = 9;
  const double digits = std::ceil(-std::log10(step) - 1e-6);
  if (!(std::abs(number) < largest) || !(digits <= most_decimals))
    return fmt::format("{:.6g}", number);
  std::string text = fmt::format("{:.{}f}", number, static_cast<int>(std::max(0.0, digits)));
  if (text.find('.') != std::string::npos)
    text.erase(text.find_last_not_of('0') + 1);
  if (text.back() == '.')
    text.pop_back();
  return text;
}

double Scale::position(double value) const {
  const double place = logarithmic ? (std::log(value) - std::log(low)) / (std::log(high) - std::log(low))
                                   : (value - low) / (high - low);
  return place > 0 ? std::min(place, 1.0) : 0.0; // not a number, too
}

Colour colour_at(double position) {
  // Lightness rises evenly; blue to yellow is the axis that every common kind of colour blindness leaves.
  constexpr std::array<std::array<double, 3>, 7> points{{{36, 46, 112},
                                                         {38, 82, 136},
                                                         {36, 117, 140},
                                                         {58, 148, 130},
                                                         {120, 181, 110},
                                                         {190, 208, 96},
                                                         {252, 236, 130}}};
  const double place = std::clamp(position, 0.0, 1.0) * (points.size() - 1);
  const auto below = std::min(static_cast<std::size_t>(place), points.size() - 2);
  const double part = place - static_cast<double>(below);
  const auto channel = [&](std::size_t c) {
    return static_cast<std::uint8_t>(
        std::lround(points[below][c] + part * (points[below + 1][c] - points[below][c])));
  };
  return {channel(0), channel(1), channel(2)};
}

Colour colour_of_slab(int slab) { return slab_colours[static_cast<std::size_t>(slab) % slab_colours.size()]; }

std::vector<double> ticks_of(const Scale &scale) {
  std::vector<double> ticks;
  if (scale.logarithmic) {
    const int first = static_cast<int>(std::ceil(std::log10(scale.low) - 1e-9));
    const int last = static_cast<int>(std::floor(std::log10(scale.high) + 1e-9));
    if (last - first >= 2) {
      for (int exponent = first; exponent <= last; exponent += (last - first + 5) / 6)
        ticks.push_back(std::pow(10.0, exponent));
      return ticks;
    }
    for (int exponent = first - 1; exponent <= last; ++exponent)
      for (const double factor : {1.0, 2.0, 5.0})
        if (const double tick = factor * std::pow(10.0, exponent); tick >= scale.low && tick <= scale.high)
          ticks.push_back(tick);
    return ticks.size() >= 2 ? ticks : std::vector{scale.low, scale.high};
  }
  const double span = scale.high - scale.low;
  double step = std::pow(10.0, std::floor(std::log10(span)));
  for (const double factor : {0.2, 0.5, 1.0, 2.0})
    if (span / (step * factor) <= 8) {
      step *= factor;
      break;
    }
  for (double k = std::ceil(scale.low / step - 1e-9);
       k * step <= scale.high + 1e-9 * span && ticks.size() < 12; ++k)
    ticks.push_back(k * step + 0.0); // not -0
  return ticks.size() >= 2 ? ticks : std::vector{scale.low, scale.high};
}

Layout lay_out(const Meaning &meaning, const Window &window, int width) {
  Layout layout;
  layout.width = width;
  layout.dot = std::max(1, width / (letters_across * letter_advance));
  const bool has_text = width >= narrowest_with_text;
  const int dot = layout.dot;
  const int margin = has_text ? std::max(4, width / 50) : 0;
  Box room{margin, margin, width - 2 * margin, 0};
  if (has_text) {
    layout.texts.push_back({margin, margin, meaning.title});
    layout.texts.push_back({margin, margin + 12 * dot, meaning.part});
    room.y += 19 * dot + margin;
  }
  layout.view = view_of(window, room);
  layout.height = room.y + layout.view.map.height + margin;
  if (!has_text)
    return layout;
  Legend legend(layout, {margin, layout.height, room.width, 0});
  if (meaning.name.empty())
    add_slabs(legend, meaning.slab_sites, dot);
  else
    legend.scale(meaning);
  if (!meaning.paths.empty())
    legend.entry(path_colour, std::max(2, dot), meaning.paths);
  if (!meaning.hull.empty())
    legend.entry(hull_colour, std::max(2, dot), meaning.hull);
  layout.height = legend.end() + margin - 3 * dot;
  return layout;
}

void draw_around(const Layout &layout, int first_row, int rows, std::vector<Colour> &pixels) {
  const auto set = [&](int x, int y, Colour colour) {
    if (x >= 0 && x < layout.width && y >= first_row && y < first_row + rows)
      pixels[static_cast<std::size_t>(y - first_row) * static_cast<std::size_t>(layout.width) +
             static_cast<std::size_t>(x)] = colour;
  };
  const auto fill = [&](const Box &box, Colour colour) {
    for (int y = std::max(box.y, first_row); y < std::min(box.y + box.height, first_row + rows); ++y)
      for (int x = box.x; x < box.x + box.width; ++x)
        set(x, y, colour);
  };
  for (const Swatch &swatch : layout.swatches)
    fill(swatch.box, swatch.colour);
  for (const Text &text : layout.texts)
    draw_text(layout, text, first_row, rows, pixels);
}

} // namespace dovetail::picture
