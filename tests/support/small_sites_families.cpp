#include "support/small_sites_families.hpp"

#include <algorithm>
#include <set>

namespace dovetail::testing {
namespace {

constexpr std::int64_t far = std::int64_t{1} << 27;

class Draw {
public:
  explicit Draw(std::mt19937_64 &random) : random_(random) {}
  std::int64_t between(std::int64_t least, std::int64_t most) {
    return std::uniform_int_distribution<std::int64_t>(least, most)(random_);
  }

private:
  std::mt19937_64 &random_;
};

using Sites = std::set<IntegerSite>;

void add_box(Sites &sites, Draw &draw, int count, std::int64_t half) {
  for (int i = 0; i < count; ++i)
    sites.insert({draw.between(-half, half), draw.between(-half, half)});
}

/// Some of the integer points on the circle of squared radius r2.
void add_circle(Sites &sites, Draw &draw, std::int64_t r2, int percent) {
  for (std::int64_t x = -20; x <= 20; ++x)
    for (std::int64_t y = -20; y <= 20; ++y)
      if (x * x + y * y == r2 && draw.between(1, 100) <= percent)
        sites.insert({x, y});
}

void add_line(Sites &sites, Draw &draw, int count, std::int64_t dx, std::int64_t dy) {
  for (int i = 0; i < count; ++i) {
    const std::int64_t at = draw.between(-30, 30);
    sites.insert({at * dx, at * dy});
  }
}

} // namespace

std::string small_sites_family_name(int family) {
  static const char *const names[small_sites_family_count] = {
      "dense lattice", "full lattice", "random",        "cocircular",
      "concentric",    "on a line",    "line and one",  "two parallel lines",
      "all x equal",   "one far site", "wide and thin", "two far clusters"};
  return names[family];
}

std::vector<IntegerSite> small_sites(int family, int most, std::mt19937_64 &random) {
  Draw draw(random);
  Sites sites;
  const int count = static_cast<int>(draw.between(0, most));
  const std::int64_t radii[] = {25, 65, 325, 50};
  switch (family) {
  case 0:
    add_box(sites, draw, count, draw.between(1, 4));
    break;
  case 1: {
    const std::int64_t columns = draw.between(1, 5);
    const std::int64_t stretch = draw.between(1, 3);
    for (int i = 0; i < count; ++i)
      sites.insert({i % columns * stretch, i / columns});
    break;
  }
  case 2:
    add_box(sites, draw, count, 1000);
    break;
  case 3:
    add_circle(sites, draw, radii[draw.between(0, 3)], static_cast<int>(draw.between(30, 100)));
    add_box(sites, draw, static_cast<int>(draw.between(0, 3)), 3);
    break;
  case 4:
    add_circle(sites, draw, 25, 60);
    add_circle(sites, draw, 65, 50);
    break;
  case 5:
    add_line(sites, draw, count, draw.between(-3, 3), draw.between(-3, 3));
    break;
  case 6:
    add_line(sites, draw, count, draw.between(-3, 3), draw.between(-3, 3));
    add_box(sites, draw, 1, 50);
    break;
  case 7:
    add_line(sites, draw, count / 2, 1, 2);
    for (int i = 0; i < count / 2; ++i) {
      const std::int64_t at = draw.between(-30, 30);
      sites.insert({at + 5, 2 * at});
    }
    break;
  case 8:
    add_line(sites, draw, count, 0, 1);
    if (draw.between(0, 1) == 1)
      add_box(sites, draw, 2, 9);
    break;
  case 9:
    add_box(sites, draw, count, 3);
    sites.insert({draw.between(-far, far), draw.between(-far, far)});
    break;
  case 10:
    for (int i = 0; i < count; ++i)
      sites.insert({draw.between(-far, far), draw.between(-1, 1)});
    break;
  default:
    for (int i = 0; i < count; ++i) {
      const std::int64_t centre = draw.between(0, 1) * far;
      sites.insert({centre + draw.between(-2, 2), draw.between(-2, 2)});
    }
  }
  std::vector<IntegerSite> result(sites.begin(), sites.end());
  std::shuffle(result.begin(), result.end(), random);
  return result;
}

} // namespace dovetail::testing
