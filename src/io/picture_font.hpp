/// Letters of 5 x 7 dots, drawn as strokes from dot to dot: digits, small letters and the signs that titles
/// and legends need. Private to io.
#pragma once

namespace dovetail::picture {

inline constexpr int glyph_width = 5;    ///< in dots; the next letter begins a dot further
inline constexpr int glyph_height = 9;   ///< seven above the line and two below
inline constexpr int letter_advance = 6; ///< from one letter to the next

/// Whether the dot is set: column 0 to 4 from the left, row 0 to 8 from the top.
bool dot_of(char character, int column, int row);

struct Dot {
  int column, row;
};

/// Calls draw(from, to) for all strokes of a letter: from every dot to its right and lower neighbours, to a
/// diagonal one only where no other dot leads there; and from every dot to itself.
template <class Draw> void for_each_stroke(char character, Draw &&draw) {
  const auto has = [character](int column, int row) {
    return column >= 0 && column < glyph_width && row < glyph_height && dot_of(character, column, row);
  };
  for (int row = 0; row < glyph_height; ++row)
    for (int column = 0; column < glyph_width; ++column) {
      if (!has(column, row))
        continue;
      draw(Dot{column, row}, Dot{column, row});
      const bool right = has(column + 1, row), below = has(column, row + 1);
      if (right)
        draw(Dot{column, row}, Dot{column + 1, row});
      if (below)
        draw(Dot{column, row}, Dot{column, row + 1});
      if (!below && !right && has(column + 1, row + 1))
        draw(Dot{column, row}, Dot{column + 1, row + 1});
      if (!below && !has(column - 1, row) && has(column - 1, row + 1))
        draw(Dot{column, row}, Dot{column - 1, row + 1});
    }
}

} // namespace dovetail::picture
