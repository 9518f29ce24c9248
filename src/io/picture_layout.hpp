/// Where title, map and legend are, what colours mean, and how points become pixels. Private to io. Local.
#pragma once

#include "dovetail/geometry/raster.hpp"
#include "dovetail/io/picture.hpp"

#include <string>
#include <vector>

namespace dovetail::picture {

inline constexpr Colour paper{255, 255, 255};
inline constexpr Colour text_colour{40, 40, 40};
inline constexpr Colour path_colour{20, 20, 20};
inline constexpr Colour hull_colour{153, 68, 85};

/// A rectangle in pixels.
struct Box {
  int x, y, width, height;
};

/// Points to pixels of the picture, y downwards.
struct View {
  Window window; ///< what the map shows
  Box map;
  double scale; ///< pixels a unit
  Point to_pixels(Point p) const {
    return {map.x + map.width / 2.0 + (p.x - (window.x0 / 2 + window.x1 / 2)) * scale,
            map.y + map.height / 2.0 - (p.y - (window.y0 / 2 + window.y1 / 2)) * scale};
  }
};

struct Swatch {
  Box box;
  Colour colour;
};
struct Text {
  int x, y; ///< the upper left corner of the first letter
  std::string text;
};

/// All that is drawn around the map.
struct Layout {
  int width = 0, height = 0;
  int dot = 1; ///< size of a letter's dot in pixels
  View view{};
  std::vector<Swatch> swatches;
  std::vector<Text> texts;
};

/// From numbers to colours: linear, or by logarithms.
struct Scale {
  double low = 0, high = 1;
  bool logarithmic = false;
  /// 0 to 1, or the nearest of both for what is outside.
  double position(double value) const;
};

/// Even in lightness, from dark blue over teal to light yellow; `position` is 0 to 1.
Colour colour_at(double position);
Colour colour_of_slab(int slab);

/// "1,234 sites".
std::string counted(GlobalIndex number, const char *name);

/// With so many decimals, or fewer, that it is told from a number that is `step` away.
std::string number_text(double number, double step);

/// What the legend says.
struct Meaning {
  std::string title;
  std::string part;                    ///< of the plane, that is shown
  std::string name;                    ///< of the scale; empty for slabs
  Scale scale;                         ///< not for slabs
  std::vector<GlobalIndex> slab_sites; ///< for slabs
  std::string paths, hull;             ///< their lines in the legend; empty if they are not drawn
};

Layout lay_out(const Meaning &meaning, const Window &window, int width);

/// The pixels of a box of the picture, row by row, with the swatches and texts that are in it.
void draw_around(const Layout &layout, int first_row, int rows, std::vector<Colour> &pixels);

/// Round numbers within a scale, twelve or fewer; its ends, if there are no two.
std::vector<double> ticks_of(const Scale &scale);

} // namespace dovetail::picture
