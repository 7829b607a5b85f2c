/// Voronoi cells of given sites as regions.
#include "crack/shatter.h"

#include <numeric>

#include <gtest/gtest.h>

#include "geometry/mass_properties.h"
#include "geometry/primitives.h"
#include "tests/crack/shapes.h"

namespace sunder::crack::test {
namespace {

constexpr double sum_bound = 1e-10;              // sums over regions are exact up to rounding
constexpr double jitter = 1e-6;                  // of the domain's diagonal, along each axis: what sites are moved by
constexpr double diagonal = 1.7320508075688772;  // of the unit cube

std::vector<Vec3> random_sites(int count, std::uint64_t seed = 1) {
  std::vector<Vec3> sites;
  for (int i = 0; i < count; ++i)
    sites.emplace_back(random_unit(seed, 0, i), random_unit(seed, 1, i), random_unit(seed, 2, i));
  return sites;
}

std::vector<Vec3> lattice_sites(int per_axis) {
  std::vector<Vec3> sites;
  for (int i = 0; i < per_axis; ++i)
    for (int j = 0; j < per_axis; ++j)
      for (int k = 0; k < per_axis; ++k) sites.push_back(Vec3(i + 0.5, j + 0.5, k + 0.5) / per_axis);
  return sites;
}

geometry::RegionBoundary cells_of(const std::vector<Vec3>& sites, const Box& domain = unit_cube(),
                                  std::uint64_t seed = 1) {
  SilentProgress progress;
  return voronoi_cells(sites, domain, seed, progress);
}

double sum_of_volumes(const geometry::RegionBoundary& boundary) {
  double sum = 0;
  for (int region = 0; region < boundary.region_count; ++region) sum += volume(boundary, region);
  return sum;
}

class Shatter : public testing::TestWithParam<std::vector<Vec3>> {};

TEST_P(Shatter, CellsAreClosedFillTheEnlargedBoxAndHoldTheirSites) {
  const std::vector<Vec3>& sites = GetParam();
  const geometry::RegionBoundary cells = cells_of(sites);
  ASSERT_EQ(cells.region_count, static_cast<int>(sites.size()));
  EXPECT_TRUE(closed(cells));
  const Box filled = filled_box(cells);
  EXPECT_NEAR((filled.min() + Vec3::Constant(0.1 * diagonal)).norm(), 0, 1e-9);  // shortest edges of 1e-10 are removed
  EXPECT_NEAR((filled.max() - Vec3::Constant(1 + 0.1 * diagonal)).norm(), 0, 1e-9);
  EXPECT_NEAR(sum_of_volumes(cells), filled.volume(), sum_bound * filled.volume());
  for (std::size_t i = 0; i < sites.size(); ++i) {
    EXPECT_GT(volume(cells, static_cast<int>(i)), 0);
    // Off the site by the jitter: lines through the corners of lattice cells would meet edges.
    EXPECT_EQ(region_at(cells, sites[i] + Vec3(1.3e-4, 2.1e-4, 0.7e-4)), static_cast<int>(i));
  }
}

TEST_P(Shatter, FacesLieHalfwayBetweenTheirSites) {
  const std::vector<Vec3>& sites = GetParam();
  const geometry::RegionBoundary cells = cells_of(sites);
  int between = 0;
  for (const auto& face : cells.faces) {
    if (face.outside < 0) continue;
    ++between;
    const Vec3 &a = sites[static_cast<std::size_t>(face.inside)], &b = sites[static_cast<std::size_t>(face.outside)];
    const std::vector<Vec3> polygon = polygon_of(cells, face, face.inside);
    for (const Vec3& x : polygon) {
      // The plane of sites that are off by d is off by d and tilts by d over their distance; corners lie up to the
      // box's size away.
      const double off = std::sqrt(3.0) * jitter * diagonal;
      EXPECT_LE(std::abs((x - (a + b) / 2).dot((b - a).normalized())), off + 2 * off * 2 * diagonal / (b - a).norm());
    }
    const Vec3 area = area_vector(polygon);
    if (area.norm() < 1e-6) continue;  // too small to point anywhere
    EXPECT_GT(area.dot(b - a), 0);
  }
  EXPECT_EQ(between > 0, sites.size() > 1);
}

INSTANTIATE_TEST_SUITE_P(Sites, Shatter,
                         testing::Values(random_sites(2), random_sites(3), random_sites(40), random_sites(300, 7),
                                         lattice_sites(2), lattice_sites(5)),
                         [](const auto& sites) {
                           return std::to_string(sites.index) + "_of_" + std::to_string(sites.param.size());
                         });

TEST(Shatter, OneSiteIsOneRegionWithNothingBetween) {
  const geometry::RegionBoundary cells = cells_of({Vec3(0.3, 0.4, 0.5)});
  EXPECT_EQ(cells.region_count, 1);
  for (const auto& face : cells.faces) EXPECT_EQ(face.outside, -1);
}

TEST(Shatter, NoSitesAreNoRegions) {
  EXPECT_EQ(cells_of({}).region_count, 0);
  EXPECT_TRUE(cells_of({}).faces.empty());
}

TEST(Shatter, TheSameSeedGivesTheSameBits) {
  const std::vector<Vec3> sites = lattice_sites(4);
  const geometry::RegionBoundary a = cells_of(sites), b = cells_of(sites), other = cells_of(sites, unit_cube(), 2);
  EXPECT_EQ(a.vertices, b.vertices);
  ASSERT_EQ(a.faces.size(), b.faces.size());
  for (std::size_t i = 0; i < a.faces.size(); ++i) {
    ASSERT_EQ(a.faces[i].loop, b.faces[i].loop);
    ASSERT_EQ(a.faces[i].inside, b.faces[i].inside);
    ASSERT_EQ(a.faces[i].outside, b.faces[i].outside);
  }
  EXPECT_NE(a.vertices, other.vertices);  // the jitter is another
}

TEST(Shatter, AFlatDomainAndAFarOneWork) {
  // A pane 1 mm thin, 1 km off: no length is absolute.
  const Vec3 far = Vec3::Constant(1000);
  const Box pane(far, far + Vec3(1, 1, 1e-3));
  std::vector<Vec3> sites;
  for (const Vec3& x : random_sites(30)) sites.push_back(far + x.cwiseProduct(pane.sizes()));
  const geometry::RegionBoundary cells = cells_of(sites, pane);
  EXPECT_EQ(cells.region_count, 30);
  EXPECT_TRUE(closed(cells));
}

TEST(Shatter, ADomainWithoutThicknessWorks) {
  std::vector<Vec3> sites = random_sites(10);
  for (Vec3& x : sites) x.z() = 0;
  const geometry::RegionBoundary cells = cells_of(sites, {Vec3::Zero(), Vec3(1, 1, 0)});
  EXPECT_EQ(cells.region_count, 10);
  EXPECT_TRUE(closed(cells));
}

TEST(Shatter, ALatticeCutsACubeIntoEqualCubes) {
  const geometry::TriangleMesh body =
      geometry::transformed(geometry::box(Vec3::Ones()), Mat3::Identity(), Vec3::Constant(0.5));
  SilentProgress progress;
  const geometry::CutResult cut = geometry::cut(body, cells_of(lattice_sites(3)), {}, progress);
  ASSERT_EQ(cut.status, geometry::CutStatus::ok) << cut.detail;
  ASSERT_EQ(cut.fragments.size(), 27u);
  for (const geometry::Fragment& fragment : cut.fragments) {
    EXPECT_TRUE(geometry::is_closed_two_manifold(fragment.mesh));
    // Six faces, each off by less than twice the jitter, on an edge of a third.
    EXPECT_NEAR(geometry::mass_properties(fragment.mesh).volume, 1.0 / 27, 6 * 2 * jitter * diagonal / 9);
  }
}

}  // namespace
}  // namespace sunder::crack::test
