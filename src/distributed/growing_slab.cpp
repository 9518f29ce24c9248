#include "growing_slab.hpp"

#include "dovetail/mesh/divide_and_conquer.hpp"
#include "vertex_moves.hpp"

#include <fmt/format.h>

namespace dovetail::insertion {
namespace {

/// Puts `added` into a column that had `old_count` values in the total order, and drops what is behind them.
template <class T>
void insert_values(std::vector<T> &column, std::size_t old_count, const SlabArrivals &arrivals,
                   std::span<const T> added) {
  column.resize(old_count);
  column.resize(old_count + added.size());
  auto end = static_cast<std::ptrdiff_t>(old_count);
  for (std::size_t j = added.size(); j-- > 0;) {
    const std::ptrdiff_t place = arrivals.places[j], to = place + static_cast<std::ptrdiff_t>(j);
    std::move_backward(column.begin() + place, column.begin() + end,
                       column.begin() + end + static_cast<std::ptrdiff_t>(j) + 1);
    column[at(to)] = added[j];
    end = place;
  }
}

} // namespace

GrowingSlab::GrowingSlab(SlabMesh &slab, const Growth &growth)
    : slab_(slab), growth_(growth), arrivals_(growth.placement.arrivals(growth.k)),
      first_site_(growth.placement.site_offsets[at(growth.slab)]) {
  std::vector<Point> &points = slab.vertices.points;
  const std::span<const Point> added = growth.placement.points(growth.k);
  const SlabPaths &paths = growth.paths;
  for (std::size_t g = 0; g < slab.ghost_number.size(); ++g)
    foreign_.emplace_back(slab.ghost_number[g], slab.own_count + static_cast<LocalIndex>(g));
  append_foreign({&paths.old_left, &paths.old_right});
  first_new_ = count();
  points.insert(points.end(), added.begin(), added.end());
  append_foreign({&paths.left, &paths.right});
  if (points.size() > most_delaunay_sites)
    throw Error({ErrorKind::resource, fmt::format("slab {}", growth.slab), "",
                 fmt::format("{} sites with those of its paths, more than the {} that one slab can have",
                             points.size(), most_delaunay_sites),
                 "triangulate all points anew, with more slabs (--slabs)"});

  on_path_.assign(points.size(), false);
  for (const auto &[number, vertex] : foreign_)
    on_path_[at(vertex)] = true;
  mark_path(paths.left, {});
  mark_path(paths.right, {});
  mark_path(paths.old_left, paths.left);
  mark_path(paths.old_right, paths.right);
}

void GrowingSlab::mark_path(const Path &path, const Path &marked) {
  auto same = marked.begin();
  for (const PathSite &site : path) {
    while (same != marked.end() && along(same->point, growth_.axis) < along(site.point, growth_.axis))
      ++same;
    if (same == marked.end() || same->number != site.number)
      on_path_[at(vertex_of(site.number))] = true;
  }
}

void GrowingSlab::append_foreign(std::initializer_list<const Path *> paths) {
  const std::size_t known = foreign_.size();
  const auto is_known = [&](GlobalIndex number) {
    const auto end = foreign_.begin() + static_cast<std::ptrdiff_t>(known);
    const auto found = std::lower_bound(foreign_.begin(), end, std::pair(number, LocalIndex{0}));
    return found != end && found->first == number;
  };
  Path further;
  for (const Path *path : paths)
    std::ranges::copy_if(*path, std::back_inserter(further), [&](const PathSite &site) {
      return !is_own(site.number) && !is_known(site.number);
    });
  std::ranges::sort(further, {}, &PathSite::number);
  const auto same = [](const PathSite &a, const PathSite &b) { return a.number == b.number; };
  further.erase(std::unique(further.begin(), further.end(), same), further.end());
  for (const PathSite &site : further) {
    foreign_.emplace_back(site.number, count());
    slab_.vertices.points.push_back(site.point);
  }
  std::ranges::sort(foreign_);
}

LocalIndex GrowingSlab::vertex_of(GlobalIndex number) const {
  if (!is_own(number))
    return std::lower_bound(foreign_.begin(), foreign_.end(), std::pair(number, LocalIndex{0}))->second;
  // New site j becomes own site places[j] + j, which ascends. Numbers come in no order, so there is no branch
  // on which half has it.
  const auto place = static_cast<LocalIndex>(number - first_site_);
  std::size_t before = 0; // new sites that are known to have lower numbers
  for (std::size_t left = arrivals_.places.size(); left > 0;) {
    const std::size_t half = (left + 1) / 2;
    before += arrivals_.place_of_new(before + half - 1) < place ? half : 0;
    left -= half;
  }
  const auto j = static_cast<LocalIndex>(before);
  const bool is_new = before < arrivals_.places.size() && arrivals_.place_of_new(before) == place;
  return is_new ? first_new_ + j : place - j;
}

std::vector<LocalIndex> GrowingSlab::places_behind_own() const {
  std::vector<LocalIndex> places(at(count() - old_own()));
  const auto place_of = [&](LocalIndex vertex) -> LocalIndex & { return places[at(vertex - old_own())]; };
  for (std::size_t j = 0; j < arrivals_.places.size(); ++j)
    place_of(first_new_ + static_cast<LocalIndex>(j)) = arrivals_.place_of_new(j);
  for (std::size_t g = 0; g < foreign_.size(); ++g)
    place_of(foreign_[g].second) = new_own() + static_cast<LocalIndex>(g);
  return places;
}

std::vector<std::size_t> GrowingSlab::renumber_corners() {
  const VertexMoves moves(arrivals_, old_own(), places_behind_own());
  const std::span<LocalIndex> corners = slab_.triangles.corners;
  std::vector<std::size_t> with_ghosts = moves.move(corners);
  std::erase_if(with_ghosts, [&](std::size_t c) { return corners[c] < new_own(); });
  return with_ghosts;
}

void GrowingSlab::settle() {
  const std::vector<std::size_t> with_ghosts = renumber_corners();
  std::vector<LocalIndex> ghosts(foreign_.size(), none);
  for (const std::size_t c : with_ghosts)
    ghosts[at(slab_.triangles.corners[c] - new_own())] = 0;
  std::vector<Point> ghost_points;
  slab_.ghost_number.clear();
  for (std::size_t g = 0; g < foreign_.size(); ++g)
    if (ghosts[g] != none) {
      ghosts[g] = new_own() + static_cast<LocalIndex>(ghost_points.size());
      ghost_points.push_back(points()[at(foreign_[g].second)]);
      slab_.ghost_number.push_back(foreign_[g].first);
    }
  for (const std::size_t c : with_ghosts)
    slab_.triangles.corners[c] = ghosts[at(slab_.triangles.corners[c] - new_own())];

  const PointTable &sites = growth_.placement.sites;
  const auto added = [&]<class T>(const std::vector<T> &column) {
    return std::span<const T>(column).subspan(growth_.placement.begins[growth_.k], arrivals_.places.size());
  };
  const std::size_t old_count = at(old_own());
  PointTable &table = slab_.vertices;
  slab_.own_count = new_own();
  slab_.first_site = first_site_;
  insert_values(table.points, old_count, arrivals_, added(sites.points));
  insert_values(table.input_index, old_count, arrivals_, added(sites.input_index));
  for (std::size_t a = 0; a < table.attributes.size(); ++a)
    insert_values(table.attributes[a].values, old_count, arrivals_, added(sites.attributes[a].values));
  table.points.insert(table.points.end(), ghost_points.begin(), ghost_points.end());
  slab_.left_path.clear();
  std::ranges::transform(growth_.paths.left, std::back_inserter(slab_.left_path), &PathSite::number);
}

} // namespace dovetail::insertion
