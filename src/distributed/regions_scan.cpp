#include "dovetail/distributed/regions_scan.hpp"

#include <algorithm>
#include <iterator>
#include <span>

namespace dovetail {
namespace {

/// Own slabs are counted by k from 0, all slabs by s = first_slab + k.
struct OwnSlabs {
  const Slabs &slabs;

  int count() const { return slabs.own_slab_count; }
  int total() const { return static_cast<int>(slabs.site_offsets.size()) - 1; }
  bool has_left_line(int k) const { return slabs.first_slab + k > 0; }
  bool has_right_line(int k) const { return slabs.first_slab + k + 1 < total(); }
  SplitLine left_line(int k) const { return line(slabs.first_slab + k - 1); }
  SplitLine right_line(int k) const { return line(slabs.first_slab + k); }
  GlobalIndex begin(int k) const { return slabs.site_offsets[index(slabs.first_slab + k)]; }
  GlobalIndex end(int k) const { return begin(k + 1); }

private:
  static std::size_t index(int s) { return static_cast<std::size_t>(s); }
  SplitLine line(int border) const { return {slabs.lines[index(border)], slabs.axis}; }
};

std::size_t index(int k) { return static_cast<std::size_t>(k); }

/// The sites of a path that lie before (in the total order) or from a site number on. The rest of a bounding
/// path is own sites, which their own hulls already have.
Path sites_before(const Path &path, GlobalIndex number) {
  Path result;
  std::copy_if(path.begin(), path.end(), std::back_inserter(result),
               [&](const PathSite &site) { return site.number < number; });
  return result;
}
Path sites_from(const Path &path, GlobalIndex number) {
  Path result;
  std::copy_if(path.begin(), path.end(), std::back_inserter(result),
               [&](const PathSite &site) { return site.number >= number; });
  return result;
}

} // namespace

SlabHulls slab_hulls(const Slabs &slabs) {
  const OwnSlabs own{slabs};
  SlabHulls hulls{std::vector<Path>(index(own.count())), std::vector<Path>(index(own.count()))};
  std::vector<Point> buffer;
  for (int k = 0; k < own.count(); ++k) {
    const std::span<const Point> sites = points_of_slab(slabs, k, buffer);
    if (own.has_left_line(k))
      hulls.left[index(k)] = own_hull(sites, own.begin(k), own.left_line(k));
    if (own.has_right_line(k))
      hulls.right[index(k)] = own_hull(sites, own.begin(k), own.right_line(k));
  }
  return hulls;
}

std::vector<Path> forward_scan(const Slabs &slabs, const SlabHulls &hulls, const Path &before) {
  const OwnSlabs own{slabs};
  std::vector<Path> chains(index(own.count()));
  const Path *previous = &before;
  for (int k = 0; k < own.count() && own.has_right_line(k); ++k) {
    chains[index(k)] = hull_of_both(*previous, hulls.right[index(k)], own.right_line(k));
    previous = &chains[index(k)];
  }
  return chains;
}

std::vector<Path> backward_scan(const Slabs &slabs, const SlabHulls &hulls, const Path &after) {
  const OwnSlabs own{slabs};
  std::vector<Path> chains(index(own.count()));
  const Path *previous = &after;
  for (int k = own.count() - 1; k >= 0 && own.has_left_line(k); --k) {
    chains[index(k)] = hull_of_both(*previous, hulls.left[index(k)], own.left_line(k));
    previous = &chains[index(k)];
  }
  return chains;
}

std::vector<Path> scan_paths(const Slabs &slabs, const SlabHulls &hulls, const Path &leftmost,
                             const Path &rightmost) {
  const OwnSlabs own{slabs};
  const int count = own.count();
  std::vector<Path> paths(index(count + 1));
  if (count == 0)
    return paths;
  paths.front() = leftmost;
  paths.back() = rightmost;
  if (count == 1)
    return paths;
  const std::vector<Path> lower = forward_scan(slabs, hulls, sites_before(leftmost, own.begin(0)));
  const std::vector<Path> upper = backward_scan(slabs, hulls, sites_from(rightmost, own.end(count - 1)));
  for (int k = 1; k < count; ++k)
    paths[index(k)] = hull_of_both(lower[index(k - 1)], upper[index(k)], own.left_line(k));
  return paths;
}

} // namespace dovetail
