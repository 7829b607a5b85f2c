#include "geometry/shape_measures.h"

#include <algorithm>
#include <numbers>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "tests/geometry/shapes.h"

namespace sunder::geometry {
namespace {

// Moments are sums of terms of their own size; a rotation moves vertices by an ulp, and eigenvalues of bodies that are
// ten times longer than thick lose two digits of the smallest.
constexpr double kRounding = 1e-11;

Vec3 descending(Vec3 sides) {
  std::sort(sides.begin(), sides.end(), std::greater<>());
  return sides;
}

ShapeMeasures measures_of(const TriangleMesh& mesh) { return shape_measures(mass_properties(mesh)).value(); }

RC_GTEST_PROP(ShapeMeasures, OfBoxesAreRatiosOfTheSides, ()) {
  const Vec3 sides(arbitrary_real(0.1, 1), arbitrary_real(0.1, 1), arbitrary_real(0.1, 1)), s = descending(sides);
  const ShapeMeasures m = measures_of(transformed(box(sides), arbitrary_rotation(), arbitrary_vector(5)));
  RC_ASSERT(std::abs(m.elongation - s[0] / s[1]) < kRounding * m.elongation);
  RC_ASSERT(std::abs(m.flatness - s[1] / s[2]) < kRounding * m.flatness);
  // A box has second moments side^2 / 12, an ellipsoid axis^2 / 20.
  RC_ASSERT((m.axes - std::sqrt(20.0 / 12) * s).norm() < kRounding);
  const double area = 2 * (s[0] * s[1] + s[1] * s[2] + s[2] * s[0]);
  const double sphere = std::cbrt(36 * std::numbers::pi) * std::pow(s.prod(), 2.0 / 3);
  RC_ASSERT(std::abs(m.sphericity - sphere / area) < kRounding);
}

/// The mesh is an icosahedron's subdivision, whose second moments are those of a sphere by symmetry, stretched.
RC_GTEST_PROP(ShapeMeasures, OfEllipsoidsAreRatiosOfTheAxes, ()) {
  const Vec3 axes(arbitrary_real(0.1, 1), arbitrary_real(0.1, 1), arbitrary_real(0.1, 1)), s = descending(axes);
  const Mat3 stretch = arbitrary_rotation() * axes.asDiagonal();
  const ShapeMeasures m = measures_of(transformed(sphere(0.5, 3), stretch, arbitrary_vector(5)));
  RC_ASSERT(std::abs(m.elongation - s[0] / s[1]) < kRounding * m.elongation);
  RC_ASSERT(std::abs(m.flatness - s[1] / s[2]) < kRounding * m.flatness);
  // 1280 flat faces lie up to 1 % inside the sphere.
  RC_ASSERT((m.axes - s).norm() < 0.01 * s.norm());
}

RC_GTEST_PROP(ShapeMeasures, KeepTheirValueWhenTurnedMovedAndScaled, ()) {
  const TriangleMesh mesh = arbitrary_shape();
  const double scale = std::pow(10, arbitrary_real(-4, 3));
  const ShapeMeasures a = measures_of(mesh);
  const ShapeMeasures b = measures_of(transformed(mesh, scale * arbitrary_rotation(), scale * arbitrary_vector(3)));
  RC_ASSERT(std::abs(a.sphericity - b.sphericity) < kRounding);
  RC_ASSERT(std::abs(a.elongation - b.elongation) < kRounding * a.elongation);
  RC_ASSERT(std::abs(a.flatness - b.flatness) < kRounding * a.flatness);
  RC_ASSERT((scale * a.axes - b.axes).norm() < kRounding * b.axes.norm());
  RC_ASSERT(a.sphericity > 0);
  RC_ASSERT(a.sphericity <= 1);
  RC_ASSERT(a.elongation >= 1);
  RC_ASSERT(a.flatness >= 1);
}

TEST(ShapeMeasures, OfASphereAreOne) {
  const ShapeMeasures m = measures_of(sphere(2, 5));
  // 20480 flat faces: volume and area are 0.05 % too small.
  EXPECT_NEAR(m.sphericity, 1, 1e-3);
  EXPECT_LT(m.sphericity, 1);
  EXPECT_NEAR(m.elongation, 1, kRounding);
  EXPECT_NEAR(m.axes.x(), 4, 4e-3);
}

TEST(ShapeMeasures, WhatIsNoSolidHasNone) {
  const TriangleMesh two_sided_triangle{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 2, 1}}};
  EXPECT_FALSE(shape_measures(mass_properties({})).has_value());
  EXPECT_FALSE(shape_measures(mass_properties(inside_out(box({1, 2, 3})))).has_value());
  EXPECT_FALSE(shape_measures(mass_properties(two_sided_triangle)).has_value());
}

}  // namespace
}  // namespace sunder::geometry
