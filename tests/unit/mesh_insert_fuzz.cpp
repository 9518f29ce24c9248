/// Sites of tiny lattices come and go at random, and the validator looks at the mesh each time. 20,000
/// operations; ten million with DOVETAIL_FULL.
#include "dovetail/mesh/flip.hpp"
#include "dovetail/mesh/insert.hpp"
#include "dovetail/mesh/remove.hpp"

#include "support/mesh_checks.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <gtest/gtest.h>
#include <random>

namespace dovetail {
namespace {

constexpr LocalIndex most_columns = 5;
constexpr std::size_t most_sites = 14;

/// One lattice, of up to 5 x 5 places, scaled and shifted: all decisions are ties, or nearly so.
class Lattice {
public:
  explicit Lattice(std::mt19937_64 &random)
      : columns_(1 + random() % most_columns), rows_(1 + random() % most_columns),
        exponent_(std::array{0, -600, 500}[random() % 3]), shear_(static_cast<double>(random() % 2)) {}

  Point any(std::mt19937_64 &random) const {
    const auto x = static_cast<double>(random() % columns_), y = static_cast<double>(random() % rows_);
    return {std::ldexp(x + shear_ * y, exponent_), std::ldexp(y, exponent_)};
  }

private:
  std::size_t columns_, rows_;
  int exponent_;
  double shear_;
};

std::size_t operations() { return std::getenv("DOVETAIL_FULL") != nullptr ? 10'000'000 : 20'000; }

TEST(InsertAndRemove, AtRandomOnTinyLattices) {
  std::mt19937_64 random(20251125);
  Cavity cavity;
  RemovalMemory removal;
  std::size_t done = 0;
  while (done < operations()) {
    const Lattice lattice(random);
    std::vector<Point> sites;
    Triangulation mesh;
    for (int i = 0; i < 100; ++i, ++done) {
      const LocalIndex count = mesh.triangle_count();
      const LocalIndex hint =
          count == 0 || random() % 4 == 0 ? none : static_cast<LocalIndex>(random() % position(count));
      const std::size_t sites_before = sites.size();
      if (sites.size() > random() % most_sites) {
        const auto vertex = static_cast<LocalIndex>(random() % sites.size());
        remove(sites, mesh, vertex, hint, removal);
        ASSERT_EQ(sites.size(), sites_before - 1);
      } else {
        const Point site = lattice.any(random);
        const bool is_known = std::ranges::find(sites, site) != sites.end();
        const Insertion inserted = random() % 2 == 0 ? insert(sites, mesh, site, hint, cavity)
                                                     : insert_by_flips(sites, mesh, site, hint, cavity);
        ASSERT_EQ(inserted.is_new, !is_known);
        ASSERT_EQ(sites[position(inserted.vertex)], site);
        ASSERT_EQ(sites.size(), sites_before + (is_known ? 0 : 1));
      }
      const FaultReport report = validate(sites, mesh, 1);
      ASSERT_TRUE(report.valid()) << "operation " << done << ": " << testing::first_fault(report);
    }
  }
}

} // namespace
} // namespace dovetail
