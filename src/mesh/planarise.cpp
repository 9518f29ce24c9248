#include "dovetail/mesh/planarise.hpp"

#include "bent_chain.hpp"
#include "dovetail/base/error.hpp"
#include "dovetail/geometry/intersection.hpp"
#include "dovetail/geometry/predicates.hpp"
#include "segment_meetings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <map>
#include <numeric>
#include <unordered_map>

namespace dovetail {
namespace {

constexpr std::size_t at(LocalIndex i) { return static_cast<std::size_t>(i); }

constexpr int most_rounds = 100; // two or three are usual

[[noreturn]] void refuse_too_close() {
  throw Error({ErrorKind::input, "segments", "",
               "they run so close together that their rounded crossings make new ones again and again",
               "move them apart, or join them"});
}

struct PointHash {
  std::size_t operator()(Point p) const {
    std::uint64_t hash = std::bit_cast<std::uint64_t>(p.x) * 0x9e3779b97f4a7c15U;
    hash = (hash ^ hash >> 32) + std::bit_cast<std::uint64_t>(p.y);
    hash *= 0xbf58476d1ce4e5b9U;
    return hash ^ hash >> 29;
  }
};

/// Pieces of segments, each between two vertices of which the first has the lower number, and what has become
/// of them: a piece that was divided is its path.
class Pieces {
public:
  LocalIndex number_of(LocalIndex a, LocalIndex b) {
    const Piece piece{std::min(a, b), std::max(a, b)};
    const std::uint64_t key =
        static_cast<std::uint64_t>(piece.from) << 32 | static_cast<std::uint32_t>(piece.to);
    const auto [entry, is_new] = numbers_.try_emplace(key, static_cast<LocalIndex>(pieces_.size()));
    if (is_new) {
      pieces_.push_back(piece);
      paths_.emplace_back();
      beside_.emplace_back();
    }
    return entry->second;
  }
  LocalIndex known(LocalIndex a, LocalIndex b) const {
    return numbers_.at(static_cast<std::uint64_t>(std::min(a, b)) << 32 |
                       static_cast<std::uint32_t>(std::max(a, b)));
  }

  std::size_t count() const { return pieces_.size(); }
  std::span<const Piece> all() const { return pieces_; }
  const Piece &piece(LocalIndex i) const { return pieces_[at(i)]; }
  /// Empty for a piece that is not divided.
  const std::vector<LocalIndex> &path(LocalIndex i) const { return paths_[at(i)]; }
  std::vector<LocalIndex> &beside(LocalIndex i) { return beside_[at(i)]; }

  void divide(LocalIndex i, const std::vector<LocalIndex> &path) {
    for (std::size_t k = 1; k < path.size(); ++k)
      number_of(path[k - 1], path[k]);
    paths_[at(i)] = path;
    beside_[at(i)] = {};
  }
  std::vector<LocalIndex> undivided() const {
    std::vector<LocalIndex> result;
    for (std::size_t i = 0; i < pieces_.size(); ++i)
      if (paths_[i].empty())
        result.push_back(static_cast<LocalIndex>(i));
    return result;
  }

private:
  std::vector<Piece> pieces_;
  std::vector<std::vector<LocalIndex>> paths_;
  std::vector<std::vector<LocalIndex>> beside_; ///< vertices on or next to each
  std::unordered_map<std::uint64_t, LocalIndex> numbers_;
};

/// The whole of a run.
class Planariser {
public:
  Planariser(const SegmentSet &given, CrossingRule rule) : given_(given), rule_(rule) {}

  Planarised run() {
    check();
    merge_vertices();
    make_pieces();
    for (int round = 0; divide_pieces(); ++round) {
      if (result_.refused)
        return std::move(result_);
      if (round == most_rounds)
        refuse_too_close();
    }
    make_chains();
    make_segments();
    count_ends();
    result_.graph.holes = given_.holes;
    result_.graph.regions = given_.regions;
    result_.graph.even_odd = given_.even_odd;
    return std::move(result_);
  }

private:
  std::vector<Point> &vertices() { return result_.graph.vertices; }
  Point point(LocalIndex v) const { return result_.graph.vertices[at(v)]; }
  LocalIndex vertex_of(LocalIndex given) const { return result_.vertex_of_input[at(given)]; }

  void check() const {
    const auto count = static_cast<LocalIndex>(given_.vertices.size());
    for (std::size_t i = 0; i < given_.segments.size(); ++i)
      if (const Segment &s = given_.segments[i];
          std::min(s.from, s.to) < 0 || std::max(s.from, s.to) >= count)
        throw Error({ErrorKind::input, "segments", fmt::format("segment {}", i),
                     fmt::format("it joins vertices {} and {} of {}", s.from, s.to, count),
                     "name vertices that there are"});
  }

  void merge_vertices() {
    const std::size_t count = given_.vertices.size();
    result_.vertex_of_input.resize(count);
    numbers_.reserve(count);
    for (std::size_t i = 0; i < count; ++i) {
      const std::int32_t marker = given_.vertex_markers.empty() ? 0 : given_.vertex_markers[i];
      const LocalIndex v = add_vertex(given_.vertices[i]);
      if (std::int32_t &kept = result_.graph.vertex_markers[at(v)]; kept == 0)
        kept = marker;
      result_.vertex_of_input[i] = v;
    }
    result_.given_vertices = static_cast<LocalIndex>(vertices().size());
    result_.repairs.duplicate_vertices = static_cast<GlobalIndex>(count - vertices().size());
  }

  LocalIndex add_vertex(Point p) {
    const auto [entry, is_new] = numbers_.try_emplace(p, static_cast<LocalIndex>(vertices().size()));
    if (is_new) {
      vertices().push_back(p);
      result_.graph.vertex_markers.push_back(0);
    }
    return entry->second;
  }

  void make_pieces() {
    has_segment_.assign(vertices().size(), 0);
    for (const Segment &segment : given_.segments) {
      const LocalIndex from = vertex_of(segment.from), to = vertex_of(segment.to);
      if (from == to) {
        ++result_.repairs.zero_length;
        continue;
      }
      has_segment_[at(from)] = has_segment_[at(to)] = 1;
      const auto before = pieces_.count();
      pieces_.number_of(from, to);
      result_.repairs.repeated += pieces_.count() == before ? 1 : 0;
    }
  }

  /// What a round has found for a piece.
  struct Division {
    std::vector<LocalIndex> on_piece;
    std::vector<LocalIndex> bends;
  };

  /// Divides what crosses or touches; false if nothing does.
  bool divide_pieces() {
    const std::size_t first_vertex = vertices().size();
    const std::size_t first_piece = pieces_.count();
    const Meetings found =
        find_meetings(vertices(), pieces_.all(), pieces_.undivided(), new_piece_, new_vertex_);
    std::map<LocalIndex, Division> divisions;
    for (const auto &[piece, v] : found.beside) {
      pieces_.beside(piece).push_back(v);
      if (is_on(piece, v)) {
        divisions[piece].on_piece.push_back(v);
        count_vertex_on_segment(v);
      }
    }
    if (rule_ == CrossingRule::refuse && !found.crossings.empty()) {
      refuse(found.crossings);
      return true;
    }
    for (const auto &[i, j] : found.crossings)
      cross(i, j, divisions);
    for (auto &[piece, division] : divisions) {
      BentChain chain(vertices(), pieces_.piece(piece), pieces_.beside(piece));
      chain.divide(std::move(division.on_piece));
      chain.bend(std::move(division.bends));
      result_.repairs.pulled += static_cast<GlobalIndex>(chain.pulled());
      if (chain.vertices().size() > 2)
        pieces_.divide(piece, chain.vertices());
    }
    new_piece_ = first_piece;
    new_vertex_ = first_vertex;
    return !divisions.empty();
  }

  bool is_on(LocalIndex piece, LocalIndex v) const {
    const Point a = point(pieces_.piece(piece).from), b = point(pieces_.piece(piece).to);
    return is_between(a, b, point(v)) && orientation(a, b, point(v)) == Sign::zero;
  }

  /// Only what was given counts as a repair of its own.
  void count_vertex_on_segment(LocalIndex v) {
    if (v < result_.given_vertices)
      ++(has_segment_[at(v)] != 0 ? result_.repairs.junctions : result_.repairs.vertices_on_segments);
  }

  void cross(LocalIndex i, LocalIndex j, std::map<LocalIndex, Division> &divisions) {
    const auto [a, b] = pieces_.piece(i);
    const auto [c, d] = pieces_.piece(j);
    const LocalIndex w = add_vertex(line_intersection(point(a), point(b), point(c), point(d)));
    ++result_.repairs.crossings;
    // A crossing that rounds to an end of one divides the other alone.
    if (w != a && w != b)
      divisions[i].bends.push_back(w);
    if (w != c && w != d)
      divisions[j].bends.push_back(w);
  }

  /// Pieces are still the segments themselves, in the order given.
  void refuse(const std::vector<std::pair<LocalIndex, LocalIndex>> &crossings) {
    const auto first_on = [&](LocalIndex piece) {
      for (std::size_t s = 0; s < given_.segments.size(); ++s) {
        const LocalIndex from = vertex_of(given_.segments[s].from), to = vertex_of(given_.segments[s].to);
        if (Piece{std::min(from, to), std::max(from, to)} == pieces_.piece(piece))
          return static_cast<LocalIndex>(s);
      }
      return LocalIndex{none};
    };
    const auto [i, j] = crossings.front();
    const auto [a, b] = pieces_.piece(i);
    const auto [c, d] = pieces_.piece(j);
    result_.refused =
        SegmentCrossing{first_on(i), first_on(j), line_intersection(point(a), point(b), point(c), point(d))};
  }

  /// From a to b, without a, through all divisions.
  void append_path(LocalIndex a, LocalIndex b, std::vector<LocalIndex> &chain) const {
    struct Step {
      LocalIndex from, to;
    };
    std::vector<Step> steps{{a, b}};
    while (!steps.empty()) {
      const Step step = steps.back();
      steps.pop_back();
      const LocalIndex number = pieces_.known(step.from, step.to);
      const std::vector<LocalIndex> &path = pieces_.path(number);
      if (path.empty()) {
        // There and back again is nowhere.
        if (chain.size() > 1 && chain[chain.size() - 2] == step.to)
          chain.pop_back();
        else
          chain.push_back(step.to);
        continue;
      }
      if (steps.size() > pieces_.count())
        refuse_too_close();
      const bool forward = pieces_.piece(number).from == step.from;
      for (std::size_t k = 1; k < path.size(); ++k) // the last one first: it is taken last
        steps.push_back(forward ? Step{path[path.size() - k - 1], path[path.size() - k]}
                                : Step{path[k], path[k - 1]});
    }
  }

  void make_chains() {
    result_.chain_offsets.assign(1, 0);
    std::vector<LocalIndex> chain;
    for (const Segment &segment : given_.segments) {
      const LocalIndex from = vertex_of(segment.from), to = vertex_of(segment.to);
      chain.assign(1, from);
      if (from != to)
        append_path(from, to, chain);
      result_.chain_vertices.insert(result_.chain_vertices.end(), chain.begin(), chain.end());
      result_.chain_offsets.push_back(static_cast<LocalIndex>(result_.chain_vertices.size()));
    }
  }

  /// Calls visit(segment given, piece) along all chains.
  template <class Visit> void for_each_link(Visit visit) const {
    for (std::size_t s = 0; s < given_.segments.size(); ++s)
      for (auto k = at(result_.chain_offsets[s]) + 1; k < at(result_.chain_offsets[s + 1]); ++k)
        visit(s, pieces_.known(result_.chain_vertices[k - 1], result_.chain_vertices[k]));
  }

  void make_segments() {
    std::vector<LocalIndex> segment_of_piece(pieces_.count(), none);
    std::vector<LocalIndex> first_given(pieces_.count(), none);
    std::vector<std::uint8_t> &crossed_freely = result_.graph.is_line;
    std::vector<Segment> &segments = result_.graph.segments;
    LocalIndex last_overlapping = none;
    for_each_link([&](std::size_t s, LocalIndex piece) {
      const auto given = static_cast<LocalIndex>(s);
      LocalIndex &number = segment_of_piece[at(piece)];
      if (number == none) {
        number = static_cast<LocalIndex>(segments.size());
        segments.push_back({pieces_.piece(piece).from, pieces_.piece(piece).to, given_.segments[s].marker});
        crossed_freely.push_back(1);
        first_given[at(piece)] = given;
      } else if (last_overlapping != given && first_given[at(piece)] != given) {
        last_overlapping = given;
        ++result_.repairs.overlapping;
      }
      if (segments[at(number)].marker == 0)
        segments[at(number)].marker = given_.segments[s].marker;
      if (given_.is_line.empty() || given_.is_line[s] == 0)
        crossed_freely[at(number)] ^= 1;
    });
    result_.repairs.overlapping -= result_.repairs.repeated; // which overlap from end to end
    if (!given_.even_odd || std::ranges::count(crossed_freely, 0) == std::ssize(crossed_freely))
      crossed_freely.clear();
  }

  void count_ends() {
    std::vector<LocalIndex> degree(vertices().size(), 0);
    for (const Segment &segment : result_.graph.segments)
      for (const LocalIndex end : {segment.from, segment.to})
        ++degree[at(end)];
    result_.repairs.hanging_ends = std::ranges::count(degree, 1);
    result_.repairs.lone_vertices = std::ranges::count(degree, 0);
  }

  const SegmentSet &given_;
  CrossingRule rule_;
  Planarised result_;
  std::unordered_map<Point, LocalIndex, PointHash> numbers_;
  std::vector<std::uint8_t> has_segment_; ///< by vertex given
  Pieces pieces_;
  std::size_t new_piece_ = 0, new_vertex_ = 0; ///< from here on not yet looked at
};

} // namespace

Planarised planarise(const SegmentSet &given, CrossingRule crossings) {
  return Planariser(given, crossings).run();
}

} // namespace dovetail
