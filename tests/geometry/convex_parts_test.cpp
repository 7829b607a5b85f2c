#include "geometry/convex_parts.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <gtest/gtest.h>

#include "geometry/detail/inside.h"
#include "geometry/inspect.h"
#include "geometry/mass_properties.h"
#include "geometry/primitives.h"
#include "tests/geometry/voronoi_regions.h"

namespace sunder::geometry {
namespace {

// Hulls have sliver faces where many points lie in one plane up to rounding; the normal of one says nothing. Faces
// flatter than this share of their longest edge are not asked: their neighbours hold the same plane.
constexpr double kSliver = 1e-6;
// How far a vertex may stand out of the plane of a face of its own hull, relative to the solid's size: rounding (1e-16)
// over the flattest face asked.
constexpr double kConvex = 1e-9;

// Negative inside: the height over the face that the point is farthest above.
double depth(const TriangleMesh& hull, const Vec3& x) {
  double highest = -std::numeric_limits<double>::infinity();
  for (const Triangle& face : hull.faces) {
    const Vec3 &a = hull.vertices[face[0]], &b = hull.vertices[face[1]], &c = hull.vertices[face[2]];
    const double longest = std::max({(b - a).norm(), (c - b).norm(), (a - c).norm()});
    const Vec3 cross = (b - a).cross(c - a);
    if (cross.norm() > kSliver * longest * longest) highest = std::max(highest, cross.normalized().dot(x - a));
  }
  return highest;
}

double distance(const ConvexParts& parts, const Vec3& x) {
  double nearest = std::numeric_limits<double>::infinity();
  for (const TriangleMesh& hull : parts.hulls) nearest = std::min(nearest, depth(hull, x));
  return nearest;
}

void expect_valid(const ConvexParts& parts, const TriangleMesh& solid, const ConvexPartsSettings& settings) {
  ASSERT_FALSE(parts.hulls.empty());
  EXPECT_LE(static_cast<int>(parts.hulls.size()), settings.max_parts);
  double sum = 0;
  for (const TriangleMesh& hull : parts.hulls) {
    EXPECT_LE(static_cast<int>(hull.vertices.size()), settings.max_hull_vertices);
    const MeshReport report = inspect(hull);
    EXPECT_TRUE(report.is_solid()) << report.summary();
    const double tolerance = kConvex * bounds(solid).diagonal().norm();
    for (const Vec3& x : hull.vertices) EXPECT_LE(depth(hull, x), tolerance);
    sum += report.volume;
  }
  const double volume = mass_properties(solid).volume;
  EXPECT_NEAR(parts.excess, (sum - volume) / volume, 1e-9);
}

TriangleMesh l_shape() {
  return revolve({{0, 0}, {2, 0}, {2, 0.5}, {0.5, 0.5}, {0.5, 2}, {0, 2}}, 12);  // a disc with a peg
}

std::vector<TriangleMesh> families() {
  return {box({1, 2, 3}), sphere(1, 3), torus(1, 0.3, 32, 12), cup(0.1, 0.006), hollow_sphere(1, 0.2, 3), l_shape()};
}

std::vector<Vec3> points_inside(const TriangleMesh& solid, int tries) {
  const detail::InsideTest inside(solid);
  const Box box = bounds(solid);
  std::vector<Vec3> result;
  for (int i = 0; i < tries; ++i) {
    const Vec3 unit(random_unit(5, 0, i), random_unit(5, 1, i), random_unit(5, 2, i));
    const Vec3 x = box.min() + unit.cwiseProduct(box.diagonal());
    if (inside(x)) result.push_back(x);
  }
  return result;
}

TEST(ConvexParts, AreValidHullsOverFamiliesOfShapes) {
  for (const TriangleMesh& solid : families()) expect_valid(convex_parts(solid), solid, {});
}

TEST(ConvexParts, CoverTheSolidWhenNoVertexIsLeftOut) {
  ConvexPartsSettings settings;
  settings.max_hull_vertices = 100000;
  for (const TriangleMesh& solid : families()) {
    const ConvexParts parts = convex_parts(solid, settings);
    expect_valid(parts, solid, settings);
    EXPECT_GE(parts.excess, -1e-9);
    const double tolerance = 1e-9 * bounds(solid).diagonal().norm();
    for (const Vec3& x : solid.vertices) EXPECT_LE(distance(parts, x), tolerance);
    for (const Vec3& x : points_inside(solid, 3000)) EXPECT_LE(distance(parts, x), tolerance);
  }
}

// n points on a unit sphere are sqrt(4 pi / n) apart. A cap of that radius has height 2 pi / n, and a hull without
// wider gaps misses the sphere by no more; even directions leave gaps up to a fifth wider.
TEST(ConvexParts, LeavingOutVerticesCostsLittle) {
  const TriangleMesh solid = sphere(1, 4);
  for (const int most : {32, 64, 256}) {
    ConvexPartsSettings settings;
    settings.max_hull_vertices = most;
    const ConvexParts parts = convex_parts(solid, settings);
    const double vertices = static_cast<double>(parts.hulls[0].vertices.size());
    EXPECT_GT(vertices, 0.9 * most);
    for (const Vec3& x : solid.vertices) ASSERT_LE(distance(parts, x), 1.2 * 1.2 * 2 * std::numbers::pi / vertices);
  }
}

TEST(ConvexParts, AConvexSolidIsOnePart) {
  for (const TriangleMesh& solid : {box({1, 2, 3}), sphere(1, 3), cylinder(1, 2, 20)}) {
    EXPECT_EQ(convex_parts(solid).hulls.size(), 1u);
  }
  EXPECT_EQ(convex_parts(box({1, 2, 3})).hulls[0].vertices.size(), 8u);
  EXPECT_NEAR(convex_parts(box({1, 2, 3})).excess, 0, 1e-12);
}

TEST(ConvexParts, ReachTheWantedExcess) {
  for (const TriangleMesh& solid : {torus(1, 0.3, 32, 12), l_shape()}) {
    const ConvexParts parts = convex_parts(solid);
    EXPECT_LE(parts.excess, ConvexPartsSettings{}.excess);
    EXPECT_GT(parts.hulls.size(), 1u);
  }
}

TEST(ConvexParts, OnePartIsTheHull) {
  ConvexPartsSettings settings;
  settings.max_parts = 1;
  const ConvexParts parts = convex_parts(torus(1, 0.3, 32, 12), settings);
  ASSERT_EQ(parts.hulls.size(), 1u);
  EXPECT_LT(distance(parts, Vec3::Zero()), 0);
}

void expect_free(const ConvexParts& parts, const Vec3& center, double radius) {
  EXPECT_GT(distance(parts, center), 0);
  for (const Vec3& direction : sphere(1, 2).vertices) EXPECT_GT(distance(parts, center + radius * direction), 0);
}

TEST(ConvexParts, ACupHoldsABall) {
  const TriangleMesh solid = cup(0.1, 0.006);
  const double outer_radius = 0.04, inner_radius = outer_radius - 0.006;
  expect_free(convex_parts(solid), {0, 0.01, 0}, 0.6 * inner_radius);
}

TEST(ConvexParts, ATorusKeepsItsHole) {
  for (const Mat3& turn : {Mat3(Mat3::Identity()), Quat(0.9, 0.3, 0.2, 0.1).normalized().toRotationMatrix()}) {
    const ConvexParts parts = convex_parts(transformed(torus(1, 0.3, 32, 12), turn, Vec3::Zero()));
    expect_free(parts, Vec3::Zero(), 0.5);
  }
}

TEST(ConvexParts, AreDeterministic) {
  const TriangleMesh solid = cup(0.1, 0.006);
  const ConvexParts a = convex_parts(solid), b = convex_parts(solid);
  ASSERT_EQ(a.hulls.size(), b.hulls.size());
  for (std::size_t i = 0; i < a.hulls.size(); ++i) {
    EXPECT_EQ(a.hulls[i].vertices, b.hulls[i].vertices);
    EXPECT_EQ(a.hulls[i].faces, b.hulls[i].faces);
  }
}

TEST(ConvexParts, TakeSlivers) {
  for (const double thickness : {1e-3, 1e-6, 1e-9, 1e-12}) {
    const TriangleMesh needle = box({1, thickness, thickness}), plate = box({1, 1, thickness});
    for (const TriangleMesh& solid : {needle, plate}) {
      const TriangleMesh turned =
          transformed(solid, Quat(0.9, 0.3, 0.2, 0.1).normalized().toRotationMatrix(), {3, 2, 1});
      EXPECT_EQ(convex_parts(solid).hulls.size(), 1u);
      EXPECT_GE(convex_parts(turned).hulls.size(), 1u);
    }
  }
}

TEST(ConvexParts, NothingInAPlane) {
  const TriangleMesh flat{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 2, 1}}};
  EXPECT_TRUE(convex_parts(flat).hulls.empty());
  EXPECT_TRUE(convex_parts({}).hulls.empty());
}

TEST(ConvexParts, TakeFragments) {
  SilentProgress progress;
  for (const TriangleMesh& body : {cup(0.1, 0.006), torus(1, 0.3, 32, 12)}) {
    const CutResult result = cut(body, random_regions(body, 24, 8, 2), {}, progress);
    ASSERT_EQ(result.status, CutStatus::ok) << result.detail;
    for (const Fragment& fragment : result.fragments) {
      expect_valid(convex_parts(fragment.mesh), fragment.mesh, {});
    }
  }
}

}  // namespace
}  // namespace sunder::geometry
