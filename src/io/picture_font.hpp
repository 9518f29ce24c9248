/// Letters of 5 x 7 dots: digits, small letters and the signs that titles and legends need. Private to io.
#pragma once

namespace dovetail::picture {

inline constexpr int glyph_width = 5;    ///< in dots; the next letter begins a dot further
inline constexpr int glyph_height = 9;   ///< seven above the line and two below
inline constexpr int letter_advance = 6; ///< from one letter to the next

/// Whether the dot is set: column 0 to 4 from the left, row 0 to 8 from the top.
bool dot_of(char character, int column, int row);

} // namespace dovetail::picture
