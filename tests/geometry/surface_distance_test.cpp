#include "geometry/surface_distance.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "core/error.h"
#include "geometry/primitives.h"

namespace sunder::geometry {
namespace {

constexpr double kRounding = 1e-12;

TEST(NearestOn, AgreesWithTheBox) {
  const TriangleMesh cube = box(Vec3(2, 2, 2));
  const Box extent = bounds(cube);
  const std::vector<Vec3> points = {extent.center(), extent.max() + Vec3(1, 2, 2), extent.max() - Vec3(0.25, 1, 1),
                                    extent.min() - Vec3(0, 0, 3)};
  const std::vector<SurfacePoint> nearest = nearest_on(cube, points);
  EXPECT_NEAR(nearest[0].distance, 1, kRounding);
  EXPECT_NEAR(nearest[1].distance, 3, kRounding);
  EXPECT_LT((nearest[1].point - extent.max()).norm(), kRounding);
  EXPECT_NEAR(nearest[2].distance, 0.25, kRounding);
  EXPECT_LT((face_normal(cube, static_cast<std::size_t>(nearest[2].face)) - Vec3::UnitX()).norm(), kRounding);
  EXPECT_NEAR(nearest[3].distance, 3, kRounding);
}

RC_GTEST_PROP(NearestOn, FindsNothingFartherThanAnyVertex, (const std::vector<std::array<int, 3>>& grid)) {
  const TriangleMesh mesh = torus(1, 0.3);
  std::vector<Vec3> points;
  for (const auto& [x, y, z] : grid) points.emplace_back(0.1 * (x % 30), 0.1 * (y % 30), 0.1 * (z % 30));
  const std::vector<SurfacePoint> nearest = nearest_on(mesh, points);
  RC_ASSERT(nearest.size() == points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Triangle& face = mesh.faces[static_cast<std::size_t>(nearest[i].face)];
    for (const Vec3& vertex : mesh.vertices) RC_ASSERT(nearest[i].distance <= (vertex - points[i]).norm() + kRounding);
    Box of_face;
    for (const int vertex : face) of_face.extend(mesh.vertices[static_cast<std::size_t>(vertex)]);
    RC_ASSERT(of_face.exteriorDistance(nearest[i].point) <= kRounding);
  }
}

TEST(HausdorffDistance, OfSpheresIsTheGapOfTheirRadii) {
  const TriangleMesh small = sphere(1), large = sphere(1.25);
  const double distance = hausdorff_distance(small, large);
  EXPECT_EQ(distance, hausdorff_distance(large, small));
  // Facets lie inside their sphere by up to 1 - cos of half an edge's angle: 0.2 % at 5120 faces.
  EXPECT_NEAR(distance, 0.25, 0.003);
  EXPECT_EQ(hausdorff_distance(small, small), 0);
}

TEST(HausdorffDistance, SeesWhatOnlyOneOfThemHas) {
  TriangleMesh with_spike = box(Vec3(1, 1, 1));
  const TriangleMesh plain = with_spike;
  const int first = static_cast<int>(with_spike.vertices.size());
  const Vec3 top = bounds(plain).max();
  for (const Vec3& x : {top, Vec3(top - Vec3(0.1, 0, 0)), Vec3(top + Vec3(0, 2, 0))}) with_spike.vertices.push_back(x);
  with_spike.faces.push_back({first, first + 1, first + 2});
  EXPECT_NEAR(hausdorff_distance(plain, with_spike), 2, kRounding);
}

TEST(NearestOn, RefusesASurfaceWithoutArea) {
  TriangleMesh line;
  line.vertices = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}};
  line.faces = {{0, 1, 2}};
  const Vec3 point = Vec3::Zero();
  EXPECT_THROW(nearest_on(line, {&point, 1}), Error);
}

}  // namespace
}  // namespace sunder::geometry
