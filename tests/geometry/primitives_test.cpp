#include "geometry/primitives.h"

#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "core/error.h"
#include "geometry/inspect.h"
#include "geometry/mass_properties.h"

namespace sunder::geometry {
namespace {

constexpr double kRounding = 1e-12;

void expect_centred_solid(const std::string& name, const TriangleMesh& mesh, const Vec3& size) {
  const MeshReport report = inspect(mesh);
  EXPECT_TRUE(report.is_solid()) << name << ": " << report.summary();
  EXPECT_LT(report.box.center().norm(), kRounding * size.norm()) << name;
  EXPECT_LT((report.box.diagonal() - size).norm(), kRounding * size.norm()) << name;
}

TEST(Primitives, SimpleSolids) {
  expect_centred_solid("box", box({1, 2, 3}), {1, 2, 3});
  expect_centred_solid("cylinder", cylinder(0.5, 3), {1, 3, 1});
  expect_centred_solid("torus", torus(1, 0.3), {2.6, 0.6, 2.6});
  EXPECT_TRUE(inspect(sphere(1, 0)).is_solid());
  EXPECT_TRUE(inspect(hollow_sphere(1, 0.01, 4)).is_solid());
}

TEST(Primitives, SphereIsSubdividedOntoTheSphere) {
  for (int n = 0; n <= 3; ++n) {
    const TriangleMesh mesh = sphere(2, n);
    EXPECT_EQ(mesh.faces.size(), 20u << 2 * n);
    for (const Vec3& vertex : mesh.vertices) ASSERT_NEAR(vertex.norm(), 2, kRounding);
  }
}

TEST(Primitives, VesselsOverTheirRangeOfWalls) {
  for (const double share : {0.01, 0.03, 0.06, 0.1}) {
    expect_centred_solid("cup", cup(0.1, share * 0.1), {0.08, 0.1, 0.08});
    EXPECT_TRUE(inspect(pot(0.3, share * 0.3)).is_solid()) << share;
    if (share < 0.04) {
      EXPECT_TRUE(inspect(goblet(0.2, share * 0.2)).is_solid()) << share;
    }
  }
}

TEST(Primitives, Column) {
  const MeshReport report = inspect(column(3));
  EXPECT_TRUE(report.is_solid()) << report.summary();
  EXPECT_EQ(report.shells, 1);
  EXPECT_NEAR(report.box.diagonal().y(), 3, kRounding);
}

// The cup is a thin shell of its wall: volume = wall * mid-surface area to first order, and half the area faces each
// side.
TEST(Primitives, CupHasItsWall) {
  const double wall = 0.001;
  const MassProperties mass = mass_properties(cup(0.1, wall));
  EXPECT_NEAR(2 * mass.volume / mass.area / wall, 1, 0.08);  // the foot ring is thicker
}

// Each band of a revolved profile is a frustum of similar regular polygons.
TEST(Primitives, RevolvedConeIsExact) {
  const int n = 12;
  const double factor = n / 2.0 * std::sin(2 * M_PI / n);
  const TriangleMesh cone = revolve({{0, 0}, {2, 0}, {1, 3}, {0, 3}}, n);
  EXPECT_TRUE(inspect(cone).is_solid());
  EXPECT_NEAR(inspect(cone).volume, factor * 3.0 / 3 * (4 + 2 + 1), 10 * kRounding);
}

TEST(Primitives, ImpossibleSizesAreRefused) {
  EXPECT_THROW(box({1, 0, 1}), Error);
  EXPECT_THROW(sphere(-1), Error);
  EXPECT_THROW(sphere(1, 7), Error);
  EXPECT_THROW(torus(1, 1), Error);
  EXPECT_THROW(hollow_sphere(1, 1), Error);
  EXPECT_THROW(cup(0.1, 0.02), Error);
  EXPECT_THROW(pot(0.1, 0), Error);
  EXPECT_THROW(goblet(0, 0.001), Error);
  EXPECT_THROW(column(0), Error);
  EXPECT_THROW(revolve({{1, 0}, {1, 1}, {0, 1}}), Error);
}

}  // namespace
}  // namespace sunder::geometry
