#include "geometry/side_of.h"

#include <cmath>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>
#include <tbb/global_control.h>

#include "core/random.h"
#include "geometry/primitives.h"
#include "tests/geometry/shapes.h"

namespace sunder::geometry {
namespace {

double solid_angle(const Vec3& a, const Vec3& b, const Vec3& c) {
  const double la = a.norm(), lb = b.norm(), lc = c.norm();
  return 2 * std::atan2(a.dot(b.cross(c)), la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
}

// Winding number by solid angles (Van Oosterom and Strackee 1983): independent of any ray.
double winding(const TriangleMesh& mesh, const Vec3& x) {
  double sum = 0;
  for (const auto& [a, b, c] : mesh.faces)
    sum += solid_angle(mesh.vertices[a] - x, mesh.vertices[b] - x, mesh.vertices[c] - x);
  return sum / (4 * M_PI);
}

// Coordinates of a lattice that the faces of the box lie on: every kind of position against faces, edges and vertices.
TEST(SideOf, ABoxExactly) {
  const TriangleMesh solid = box({2, 2, 2});
  std::vector<Vec3> points;
  std::vector<Side> wanted;
  for (int i = 0; i < 7 * 7 * 7; ++i) {
    const Vec3 x = 0.5 * Vec3(i % 7 - 3, i / 7 % 7 - 3, i / 49 - 3);
    const double height = x.cwiseAbs().maxCoeff();
    points.push_back(x);
    wanted.push_back(height > 1 ? Side::outside : height == 1 ? Side::on : Side::inside);
  }
  EXPECT_EQ(side_of(solid, points), wanted);
}

TEST(SideOf, TheNextNumberIsNotOn) {
  const TriangleMesh solid = box({2, 2, 2});
  for (int axis = 0; axis < 3; ++axis) {
    Vec3 x(0.3, 0.2, 0.1), inner, outer;
    x[axis] = 1;
    inner = outer = x;
    inner[axis] = std::nextafter(1, 0);
    outer[axis] = std::nextafter(1, 2);
    EXPECT_EQ(side_of(solid, {x, inner, outer}), (std::vector<Side>{Side::on, Side::inside, Side::outside})) << axis;
  }
}

TEST(SideOf, VerticesAndTheVoidOfAHollowSphere) {
  const TriangleMesh solid = hollow_sphere(1, 0.2, 3);
  EXPECT_EQ(side_of(solid, solid.vertices), std::vector<Side>(solid.vertices.size(), Side::on));
  EXPECT_EQ(side_of(solid, {{0, 0, 0}, {0, 0.9, 0}, {1, 1, 1}}),
            (std::vector<Side>{Side::outside, Side::inside, Side::outside}));
}

TEST(SideOf, DoesNotDependOnThreads) {
  const TriangleMesh solid = torus(1, 0.3);
  std::vector<Vec3> points(5000);
  for (int i = 0; i < 5000; ++i) {
    for (int axis = 0; axis < 3; ++axis) points[i][axis] = 3 * random_unit(1, axis, i) - 1.5;
  }
  const std::vector<Side> all = side_of(solid, points);
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, 1);
  EXPECT_EQ(side_of(solid, points), all);
}

RC_GTEST_PROP(SideOf, AgreesWithTheWindingNumber, ()) {
  const TriangleMesh solid = transformed(arbitrary_shape(), arbitrary_rotation(), arbitrary_vector(1));
  const Vec3 x = bounds(solid).center() + arbitrary_vector(1);
  const double around = winding(solid, x);
  RC_PRE(std::abs(around - std::round(around)) < 1e-6);  // not on the surface
  RC_ASSERT(side_of(solid, {x})[0] == (around > 0.5 ? Side::inside : Side::outside));
}

}  // namespace
}  // namespace sunder::geometry
