#include "geometry/decimate.h"

#include <cmath>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "core/error.h"
#include "geometry/inspect.h"
#include "geometry/load.h"
#include "geometry/primitives.h"
#include "tests/geometry/cut_checks.h"
#include "tests/geometry/shapes.h"

namespace sunder::geometry {
namespace {

// Every collapse keeps the volume up to rounding; thousands of them add up. Measured: 3e-15 (bunny) to 1.4e-13.
constexpr double kVolume = 1e-11;

double volume(const TriangleMesh& mesh) { return mass_properties(mesh).volume; }

void expect_sound(const TriangleMesh& solid, const TriangleMesh& coarse) {
  EXPECT_TRUE(is_closed_two_manifold(coarse));
  EXPECT_EQ(inspect(coarse).shells, inspect(solid).shells);
  EXPECT_EQ(euler_characteristic(coarse), euler_characteristic(solid));
  EXPECT_NEAR(volume(coarse) / volume(solid), 1, kVolume);
}

TEST(Decimate, KeepsVolumeAndTopologyOverFamiliesOfShapes) {
  for (const TriangleMesh& solid :
       {sphere(1, 4), torus(1, 0.3), cup(0.1, 0.006), goblet(0.2, 0.002), column(3), hollow_sphere(1, 0.1, 4),
        together(sphere(1, 3), moved(torus(1, 0.3), {4, 0, 0}))}) {
    const int budget = static_cast<int>(solid.faces.size()) / 10;
    const TriangleMesh coarse = decimated(solid, budget);
    EXPECT_LE(static_cast<int>(coarse.faces.size()), budget);
    EXPECT_GE(static_cast<int>(coarse.faces.size()), budget - 1);
    expect_sound(solid, coarse);
    EXPECT_EQ(inspect(coarse).self_intersections, 0);
  }
}

TEST(Decimate, ScannedMesh) {
  const auto file = sample_mesh("bunny00.off");
  if (!std::filesystem::exists(file)) GTEST_SKIP() << file << " is missing";
  const TriangleMesh bunny = load_mesh(file);
  const TriangleMesh coarse = decimated(bunny, static_cast<int>(bunny.faces.size()) / 10);
  expect_sound(bunny, coarse);
  EXPECT_TRUE(inspect(coarse).is_solid());
  // The surface moves by less than a percent of the size (the box follows).
  const Box before = bounds(bunny), after = bounds(coarse);
  EXPECT_LT((before.min() - after.min()).norm(), 0.01 * before.diagonal().norm());
  EXPECT_LT((before.max() - after.max()).norm(), 0.01 * before.diagonal().norm());
  std::printf("bunny: %zu -> %zu faces, volume change %.1e\n", bunny.faces.size(), coarse.faces.size(),
              volume(coarse) / volume(bunny) - 1);
}

TEST(Decimate, UnderBudgetNothingChanges) {
  const TriangleMesh solid = sphere(1, 2);
  for (const int budget : {320, 1000}) {
    const TriangleMesh same = decimated(solid, budget);
    EXPECT_EQ(same.vertices, solid.vertices);
    EXPECT_EQ(same.faces, solid.faces);
  }
}

TEST(Decimate, IsDeterministic) {
  const TriangleMesh solid = cup(0.1, 0.006);
  const TriangleMesh a = decimated(solid, 500), b = decimated(solid, 500);
  EXPECT_EQ(a.vertices, b.vertices);
  EXPECT_EQ(a.faces, b.faces);
}

// Two shells need eight faces, and a torus more than four.
TEST(Decimate, TopologyLimitsTheBudget) {
  const TriangleMesh two = decimated(hollow_sphere(1, 0.5, 2), 4);
  EXPECT_GE(two.faces.size(), 8u);
  EXPECT_EQ(inspect(two).shells, 2);
  const TriangleMesh ring = decimated(torus(1, 0.3, 24, 12), 4);
  EXPECT_GE(ring.faces.size(), 14u);  // no closed surface with a handle has fewer
  EXPECT_EQ(euler_characteristic(ring), 0);
}

TEST(Decimate, RefusesNonsense) {
  EXPECT_THROW(decimated(sphere(1, 2), 3), Error);
  TriangleMesh open = sphere(1, 2);
  open.faces.pop_back();
  EXPECT_THROW(decimated(open, 100), Error);
}

RC_GTEST_PROP(Decimate, AnySolidStaysClosed, ()) {
  const TriangleMesh solid = transformed(arbitrary_shape(), arbitrary_rotation(), arbitrary_vector(2));
  const int budget = *rc::gen::inRange(4, static_cast<int>(solid.faces.size()) + 2);
  const TriangleMesh coarse = decimated(solid, budget);
  RC_ASSERT(is_closed_two_manifold(coarse));
  RC_ASSERT(euler_characteristic(coarse) == euler_characteristic(solid));
  RC_ASSERT(std::abs(volume(coarse) / volume(solid) - 1) < kVolume);
}

}  // namespace
}  // namespace sunder::geometry
