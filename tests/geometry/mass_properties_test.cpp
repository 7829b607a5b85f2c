#include "geometry/mass_properties.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "geometry/primitives.h"
#include "tests/geometry/shapes.h"

namespace sunder::geometry {
namespace {

using std::numbers::pi;

// Sums over up to 1e5 faces of terms of the size of the result: rounding stays two digits below this.
constexpr double kRounding = 1e-12;

Mat3 box_inertia(const Vec3& size, double mass) {
  const Vec3 squared = size.cwiseProduct(size);
  return (mass / 12 * (Vec3::Constant(squared.sum()) - squared)).asDiagonal();
}

double relative(const Mat3& a, const Mat3& b) { return (a - b).norm() / b.norm(); }

TEST(MassProperties, BoxIsExact) {
  const Vec3 size(1, 2, 3);
  const MassProperties mass = mass_properties(box(size));
  EXPECT_NEAR(mass.volume, 6, 6 * kRounding);
  EXPECT_NEAR(mass.area, 22, 22 * kRounding);
  EXPECT_LT(mass.centroid.norm(), kRounding);
  EXPECT_LT(relative(mass.inertia, box_inertia(size, 6)), kRounding);
}

// A tetrahedron has no symmetry that could hide a wrong product of inertia. Tonon, "Explicit exact formulas for the 3-D
// tetrahedron inertia tensor" (2004): about the centroid, second moment = V/20 sum (v - c)(v - c)^T.
TEST(MassProperties, TetrahedronIsExact) {
  const TriangleMesh mesh{{{0.1, 0.2, -0.3}, {2, 0.4, 0.5}, {0.3, 1.5, 0.2}, {-0.4, 0.6, 3}},
                          {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}}};
  const auto& v = mesh.vertices;
  const double volume = (v[1] - v[0]).dot((v[2] - v[0]).cross(v[3] - v[0])) / 6;
  const Vec3 centroid = (v[0] + v[1] + v[2] + v[3]) / 4;
  Mat3 second = Mat3::Zero();
  for (const Vec3& x : v) second += volume / 20 * (x - centroid) * (x - centroid).transpose();
  const MassProperties mass = mass_properties(mesh);
  EXPECT_NEAR(mass.volume, volume, kRounding);
  EXPECT_LT((mass.centroid - centroid).norm(), kRounding);
  EXPECT_LT(relative(mass.inertia, second.trace() * Mat3::Identity() - second), kRounding);
}

// The prism over a regular n-gon with circumradius r: area n/2 r^2 sin(2 pi/n), and polar second moment of the section
// area r^2 / 6 (2 + cos(2 pi/n)).
TEST(MassProperties, RegularPrismIsExact) {
  const double r = 0.7, height = 1.3;
  const int n = 64;
  const double area = n / 2.0 * r * r * std::sin(2 * pi / n), polar = area * r * r / 6 * (2 + std::cos(2 * pi / n));
  const double across = height * polar / 2 + area * height * height * height / 12;
  const MassProperties mass = mass_properties(cylinder(r, height, n));
  EXPECT_NEAR(mass.volume, area * height, kRounding);
  EXPECT_LT(relative(mass.inertia, Vec3(across, polar * height, across).asDiagonal()), kRounding);
}

TEST(MassProperties, VoidIsSubtracted) {
  const double outer = mass_properties(sphere(1)).volume, inner = mass_properties(sphere(0.9)).volume;
  EXPECT_NEAR(mass_properties(hollow_sphere(1, 0.1)).volume, outer - inner, kRounding);
}

TEST(MassProperties, InsideOutIsNegative) { EXPECT_DOUBLE_EQ(mass_properties(inside_out(box({1, 2, 3}))).volume, -6); }

TEST(MassProperties, FlatMeshFallsBackToTheBoxCentre) {
  const TriangleMesh sheet{{{1, 0, 0}, {3, 0, 0}, {1, 2, 0}}, {{0, 1, 2}, {0, 2, 1}}};
  EXPECT_EQ(mass_properties(sheet).centroid, Vec3(2, 1, 0));
  EXPECT_EQ(mass_properties({}).centroid, Vec3(0, 0, 0));
}

TEST(MassProperties, KeepsItsDigitsFarFromTheOrigin) {
  // 2^20 m away the positions themselves are rounded to 2^-32 m: 1e-9 is what the input still knows.
  const TriangleMesh far = transformed(sphere(1, 3), Mat3::Identity(), Vec3::Constant(1 << 20));
  const MassProperties here = mass_properties(sphere(1, 3)), there = mass_properties(far);
  EXPECT_NEAR(there.volume, here.volume, 1e-8);
  EXPECT_LT(relative(there.inertia, here.inertia), 1e-8);
}

RC_GTEST_PROP(MassProperties, RigidMotionsCarryCentroidAndInertia, ()) {
  const TriangleMesh mesh = arbitrary_shape();
  const Mat3 rotation = arbitrary_rotation();
  const Vec3 shift = arbitrary_vector(3);
  const MassProperties before = mass_properties(mesh), after = mass_properties(transformed(mesh, rotation, shift));
  RC_ASSERT(std::abs(after.volume / before.volume - 1) < kRounding);
  RC_ASSERT(std::abs(after.area / before.area - 1) < kRounding);
  RC_ASSERT((after.centroid - (rotation * before.centroid + shift)).norm() < 10 * kRounding);
  RC_ASSERT(relative(after.inertia, rotation * before.inertia * rotation.transpose()) < 10 * kRounding);
}

RC_GTEST_PROP(MassProperties, ScaleWithTheirPowers, ()) {
  const TriangleMesh mesh = arbitrary_shape();
  const double scale = std::exp(arbitrary_real(-5, 5));
  const MassProperties before = mass_properties(mesh);
  const MassProperties after = mass_properties(transformed(mesh, scale * Mat3::Identity(), Vec3::Zero()));
  RC_ASSERT(std::abs(after.volume / (before.volume * std::pow(scale, 3)) - 1) < kRounding);
  RC_ASSERT(std::abs(after.area / (before.area * std::pow(scale, 2)) - 1) < kRounding);
  RC_ASSERT(relative(after.inertia, std::pow(scale, 5) * before.inertia) < 10 * kRounding);
}

// Volume and second moments of a linear image: V' = |det A| V, C' = |det A| A C A^T.
RC_GTEST_PROP(MassProperties, FollowLinearMaps, ()) {
  const TriangleMesh mesh = arbitrary_shape();
  Mat3 map;
  map << arbitrary_vector(2), arbitrary_vector(2), arbitrary_vector(2);
  RC_PRE(std::abs(map.determinant()) > 0.1);
  const auto second = [](const MassProperties& mass) {
    return Mat3(mass.inertia.trace() / 2 * Mat3::Identity() - mass.inertia);
  };
  const MassProperties before = mass_properties(mesh), after = mass_properties(transformed(mesh, map, Vec3::Zero()));
  const double det = std::abs(map.determinant());
  // The map's condition number enters.
  RC_ASSERT(std::abs(after.volume / (before.volume * det) - 1) < 100 * kRounding);
  RC_ASSERT(relative(second(after), det * map * second(before) * map.transpose()) < 100 * kRounding);
}

}  // namespace
}  // namespace sunder::geometry
