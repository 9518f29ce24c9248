#include "segment_meetings.hpp"

#include "dovetail/geometry/constructions.hpp"
#include "dovetail/geometry/predicates.hpp"
#include "strips.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace dovetail {
namespace {

constexpr std::size_t at(LocalIndex i) { return static_cast<std::size_t>(i); }

constexpr std::size_t few = 12;   // pieces that are compared with each other
constexpr int most_cuts = 96;     // one in another
constexpr double most_copies = 4; // of a piece, in the mean, by cuts that it lies on both sides of

struct Box {
  double low_x, low_y, high_x, high_y;
  bool holds(Point p) const { return low_x <= p.x && p.x < high_x && low_y <= p.y && p.y < high_y; }
  Point middle() const { return {0.5 * low_x + 0.5 * high_x, 0.5 * low_y + 0.5 * high_y}; }
  double half_width() const { return 0.5 * high_x - 0.5 * low_x; }
  double half_height() const { return 0.5 * high_y - 0.5 * low_y; }
};

/// Coordinates along and across a direction, from the middle of a box.
struct Frame {
  Point middle;
  Displacement direction; ///< its longer component is 1
  double along(Point p) const { return dot(direction, p - middle); }
  double across(Point p) const { return cross(direction, p - middle); }
};

/// What is in a part of the plane.
struct Part {
  Box box;
  std::vector<LocalIndex> pieces;
  std::vector<LocalIndex> vertices;
  int cuts = 0;
  double copies = 1;
};

class Search {
public:
  Search(std::span<const Point> vertices, std::span<const Piece> pieces, std::size_t new_piece,
         std::size_t new_vertex, Meetings &found)
      : vertices_(vertices), pieces_(pieces), new_piece_(new_piece), new_vertex_(new_vertex), found_(found) {}

  void run(Part whole) {
    std::vector<Part> parts;
    parts.push_back(std::move(whole));
    while (!parts.empty()) {
      Part part = std::move(parts.back());
      parts.pop_back();
      if (!has_news(part))
        continue;
      if (part.pieces.size() <= few || part.cuts >= most_cuts ||
          (share_a_vertex(part) ? part.vertices.size() <= 1 : part.copies >= most_copies)) {
        compare(part);
        continue;
      }
      auto [low, high] = cut(part);
      parts.push_back(std::move(low));
      parts.push_back(std::move(high));
    }
  }

private:
  Point point(LocalIndex v) const { return vertices_[at(v)]; }
  bool is_new_piece(LocalIndex piece) const { return at(piece) >= new_piece_; }
  bool is_new_vertex(LocalIndex v) const { return at(v) >= new_vertex_; }

  /// Of a piece: how far beside it something is looked for.
  double reach(const Piece &piece) const {
    const Point a = point(piece.from), b = point(piece.to);
    return 0x1p-48 * std::max({std::fabs(a.x), std::fabs(a.y), std::fabs(b.x), std::fabs(b.y)}) +
           std::numeric_limits<double>::min();
  }

  bool has_news(const Part &part) const {
    return std::ranges::any_of(part.pieces, [&](LocalIndex piece) { return is_new_piece(piece); }) ||
           (!part.pieces.empty() &&
            std::ranges::any_of(part.vertices, [&](LocalIndex v) { return is_new_vertex(v); }));
  }

  bool share_a_vertex(const Part &part) const {
    const Piece &first = pieces_[at(part.pieces.front())];
    const auto all_have = [&](LocalIndex v) {
      return std::ranges::all_of(part.pieces, [&](LocalIndex piece) {
        return pieces_[at(piece)].from == v || pieces_[at(piece)].to == v;
      });
    };
    return all_have(first.from) || all_have(first.to);
  }

  /// No piece that touches the box within its reach is missed. What overflows counts as touching.
  bool touches(const Piece &piece, const Box &box) const {
    const Point a = point(piece.from), b = point(piece.to);
    const double margin = reach(piece);
    if (std::max(a.x, b.x) + margin < box.low_x || std::min(a.x, b.x) - margin > box.high_x ||
        std::max(a.y, b.y) + margin < box.low_y || std::min(a.y, b.y) - margin > box.high_y)
      return false;
    // The corners of the box, seen across the line; an unbounded box has none.
    const double dx = b.x - a.x, dy = b.y - a.y;
    const auto [x, y] = box.middle();
    const double half_x = box.half_width(), half_y = box.half_height();
    const double across_line = std::fabs(dx * (y - a.y) - dy * (x - a.x));
    const double rounding = 0x1p-48 * (std::fabs(x) + std::fabs(y) + half_x + half_y);
    const double most =
        (half_x + margin + rounding) * std::fabs(dy) + (half_y + margin + rounding) * std::fabs(dx);
    return !(across_line > most);
  }

  struct Halves {
    Part low, high;
  };

  /// At the median of the vertices; where there are few, in the middle of the box.
  Halves cut(Part &part) const {
    const auto extent = [&](auto coordinate) {
      double low = std::numeric_limits<double>::infinity(), high = -low;
      for (const LocalIndex v : part.vertices) {
        low = std::min(low, coordinate(point(v)));
        high = std::max(high, coordinate(point(v)));
      }
      return 0.5 * high - 0.5 * low;
    };
    const auto x_of = [](Point p) { return p.x; };
    const auto y_of = [](Point p) { return p.y; };
    Box low = part.box, high = part.box;
    if (part.vertices.size() > few) {
      const bool along_x = extent(x_of) >= extent(y_of);
      const auto middle = part.vertices.begin() + static_cast<std::ptrdiff_t>(part.vertices.size() / 2);
      std::ranges::nth_element(part.vertices, middle, {},
                               [&](LocalIndex v) { return along_x ? point(v).x : point(v).y; });
      if (along_x)
        low.high_x = high.low_x = point(*middle).x;
      else
        low.high_y = high.low_y = point(*middle).y;
    } else if (part.box.half_width() >= part.box.half_height()) {
      low.high_x = high.low_x = part.box.middle().x;
    } else {
      low.high_y = high.low_y = part.box.middle().y;
    }
    Halves halves{share(part, low), share(part, high)};
    const auto after = static_cast<double>(halves.low.pieces.size() + halves.high.pieces.size());
    halves.low.copies = halves.high.copies = part.copies * after / static_cast<double>(part.pieces.size());
    return halves;
  }

  Part share(const Part &part, const Box &box) const {
    Part result{box, {}, {}, part.cuts + 1, 1};
    std::ranges::copy_if(part.pieces, std::back_inserter(result.pieces),
                         [&](LocalIndex piece) { return touches(pieces_[at(piece)], box); });
    std::ranges::copy_if(part.vertices, std::back_inserter(result.vertices),
                         [&](LocalIndex v) { return box.holds(point(v)); });
    return result;
  }

  void compare(const Part &part) {
    const bool share = share_a_vertex(part);
    if (part.pieces.size() > few && !share)
      return compare_strips(part);
    if (!share)
      for (std::size_t i = 0; i < part.pieces.size(); ++i)
        for (std::size_t j = 0; j < i; ++j)
          compare_pieces(part.pieces[i], part.pieces[j]);
    for (const LocalIndex piece : part.pieces)
      for (const LocalIndex v : part.vertices)
        compare_with_vertex(piece, v);
  }

  /// Many pieces are long and close together: seen along them, each is a strip across the box, and so is each
  /// vertex in the box that is none of their ends.
  void compare_strips(const Part &part) {
    const LocalIndex longest = *std::ranges::max_element(part.pieces, {}, [&](LocalIndex piece) {
      const Point a = point(pieces_[at(piece)].from), b = point(pieces_[at(piece)].to);
      const auto [first, last] = part_inside(a, b, part.box, 0);
      return (last - first) * distance(a, b);
    });
    const Displacement d = point(pieces_[at(longest)].to) - point(pieces_[at(longest)].from);
    const double length = std::max(std::fabs(d.x), std::fabs(d.y));
    const Frame frame{part.box.middle(), {d.x / length, d.y / length}};
    const std::vector<LocalIndex> alone = no_ends(part);
    std::vector<Strip> strips;
    strips.reserve(part.pieces.size() + alone.size());
    for (const LocalIndex piece : part.pieces)
      strips.push_back(strip_of(pieces_[at(piece)], part.box, frame));
    for (const LocalIndex v : alone)
      strips.push_back(strip_of({v, v}, part.box, frame));
    for_each_meeting(strips, part.pieces.size(), [&](std::size_t i, std::size_t j) {
      const auto [first, second] = std::minmax(i, j);
      const LocalIndex piece = part.pieces[first];
      if (second >= part.pieces.size())
        return compare_with_vertex(piece, alone[second - part.pieces.size()]);
      const LocalIndex other = part.pieces[second];
      compare_pieces(piece, other);
      for (const LocalIndex end : {pieces_[at(other)].from, pieces_[at(other)].to})
        compare_with_vertex(piece, end);
      for (const LocalIndex end : {pieces_[at(piece)].from, pieces_[at(piece)].to})
        compare_with_vertex(other, end);
    });
  }

  /// Of the vertices, those in which no piece ends.
  std::vector<LocalIndex> no_ends(const Part &part) const {
    std::vector<LocalIndex> ends;
    for (const LocalIndex piece : part.pieces)
      ends.insert(ends.end(), {pieces_[at(piece)].from, pieces_[at(piece)].to});
    std::ranges::sort(ends);
    std::vector<LocalIndex> result;
    std::ranges::copy_if(part.vertices, std::back_inserter(result),
                         [&](LocalIndex v) { return !std::ranges::binary_search(ends, v); });
    return result;
  }

  /// A strip across the box, as far as the frame sees it, with all of the piece in it that is in the box and
  /// what is within reach of that: the piece's line, if it is long and runs along, or else the range across
  /// that it takes.
  Strip strip_of(const Piece &piece, const Box &box, const Frame &frame) const {
    const Point a = point(piece.from), b = point(piece.to);
    const double half_length =
        std::fabs(frame.direction.x) * box.half_width() + std::fabs(frame.direction.y) * box.half_height();
    // Both coordinates of an end are off by less than 2^-50 of the coordinates that they are made of; on a
    // line half as long as the strip, this can be ten times as much where it is continued to the strip's
    // ends. What is beside is at most three times the reach away, as measured across.
    const double margin =
        8 * (reach(piece) + 0x1p-48 * (std::fabs(frame.middle.x) + std::fabs(frame.middle.y)));
    const double from = frame.along(a), to = frame.along(b);
    const double slope = (frame.across(b) - frame.across(a)) / (to - from);
    Strip strip{};
    if (std::fabs(to - from) > half_length && std::fabs(slope) <= 1) {
      strip.left_low = strip.left_high = frame.across(a) + (-half_length - from) * slope;
      strip.right_low = strip.right_high = frame.across(a) + (half_length - from) * slope;
    } else {
      const auto [first, last] = part_inside(a, b, box, margin);
      const double low = frame.across(between(a, b, first)), high = frame.across(between(a, b, last));
      strip.left_low = strip.right_low = std::min(low, high);
      strip.left_high = strip.right_high = std::max(low, high);
    }
    if (!std::isfinite(strip.left_high - strip.left_low + strip.right_high - strip.right_low))
      return {-HUGE_VAL, HUGE_VAL, -HUGE_VAL, HUGE_VAL}; // beyond the range of doubles
    return {strip.left_low - margin, strip.left_high + margin, strip.right_low - margin,
            strip.right_high + margin};
  }

  struct Fractions {
    double first, last;
  };

  /// Of ab, what is in the box or next to it.
  static Fractions part_inside(Point a, Point b, const Box &box, double margin) {
    Fractions inside{0, 1};
    const auto clip = [&](double from, double to, double low, double high) {
      if (from == to)
        return;
      const auto [enters, leaves] =
          std::minmax({(low - margin - from) / (to - from), (high + margin - from) / (to - from)});
      inside = {std::clamp(enters, inside.first, inside.last), std::clamp(leaves, inside.first, inside.last)};
    };
    clip(a.x, b.x, box.low_x, box.high_x);
    clip(a.y, b.y, box.low_y, box.high_y);
    return inside;
  }

  void compare_with_vertex(LocalIndex piece, LocalIndex v) {
    if ((is_new_piece(piece) || is_new_vertex(v)) && is_beside(pieces_[at(piece)], v))
      found_.beside.emplace_back(piece, v);
  }

  void compare_pieces(LocalIndex i, LocalIndex j) {
    const auto [a, b] = pieces_[at(i)];
    const auto [c, d] = pieces_[at(j)];
    if ((!is_new_piece(i) && !is_new_piece(j)) || a == c || a == d || b == c || b == d)
      return;
    if (boxes_are_apart(point(a), point(b), point(c), point(d)))
      return;
    const Sign of_c = orientation(point(a), point(b), point(c));
    if (of_c == Sign::zero || of_c != -orientation(point(a), point(b), point(d)))
      return;
    const Sign of_a = orientation(point(c), point(d), point(a));
    if (of_a != Sign::zero && of_a == -orientation(point(c), point(d), point(b)))
      found_.crossings.emplace_back(std::min(i, j), std::max(i, j));
  }

  static bool boxes_are_apart(Point a, Point b, Point c, Point d) {
    return std::max(a.x, b.x) < std::min(c.x, d.x) || std::max(c.x, d.x) < std::min(a.x, b.x) ||
           std::max(a.y, b.y) < std::min(c.y, d.y) || std::max(c.y, d.y) < std::min(a.y, b.y);
  }

  bool is_beside(const Piece &piece, LocalIndex v) const {
    if (v == piece.from || v == piece.to)
      return false;
    const Point a = point(piece.from), b = point(piece.to), p = point(v);
    const double margin = reach(piece);
    if (p.x < std::min(a.x, b.x) - margin || p.x > std::max(a.x, b.x) + margin ||
        p.y < std::min(a.y, b.y) - margin || p.y > std::max(a.y, b.y) + margin)
      return false;
    const double dx = b.x - a.x, dy = b.y - a.y;
    // Rounding reaches a few 2^-53, so nothing nearer than half of the margin is missed.
    return !(std::fabs(dx * (p.y - a.y) - dy * (p.x - a.x)) > margin * (std::fabs(dx) + std::fabs(dy)));
  }

  std::span<const Point> vertices_;
  std::span<const Piece> pieces_;
  std::size_t new_piece_, new_vertex_;
  Meetings &found_;
};

void sort_out(std::vector<std::pair<LocalIndex, LocalIndex>> &pairs) {
  std::sort(pairs.begin(), pairs.end());
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
}

} // namespace

Meetings find_meetings(std::span<const Point> vertices, std::span<const Piece> pieces,
                       std::vector<LocalIndex> live, std::size_t new_piece, std::size_t new_vertex) {
  Meetings found;
  Part whole{};
  // A box that holds them all: its upper sides are not part of it.
  constexpr double infinity = std::numeric_limits<double>::infinity();
  whole.box = {infinity, infinity, -infinity, -infinity};
  for (const Point p : vertices) {
    whole.box.low_x = std::min(whole.box.low_x, p.x);
    whole.box.low_y = std::min(whole.box.low_y, p.y);
    whole.box.high_x = std::max(whole.box.high_x, std::nextafter(p.x, infinity));
    whole.box.high_y = std::max(whole.box.high_y, std::nextafter(p.y, infinity));
  }
  whole.pieces = std::move(live);
  whole.vertices.resize(vertices.size());
  std::iota(whole.vertices.begin(), whole.vertices.end(), 0);
  Search(vertices, pieces, new_piece, new_vertex, found).run(std::move(whole));
  sort_out(found.crossings);
  sort_out(found.beside);
  return found;
}

} // namespace dovetail
