#include "geometry/mesh.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "geometry/mass_properties.h"
#include "geometry/primitives.h"

namespace sunder::geometry {
namespace {

TEST(Mesh, BoundsOfNothingAreEmpty) { EXPECT_TRUE(bounds({}).isEmpty()); }

TEST(Mesh, BoundsHoldVerticesThatNoFaceUses) {
  TriangleMesh mesh = box({1, 1, 1});
  mesh.vertices.emplace_back(5, 0, 0);
  EXPECT_EQ(bounds(mesh).max(), Vec3(5, 0.5, 0.5));
}

TEST(Mesh, TransformedMovesVertices) {
  const TriangleMesh mesh = transformed(box({1, 1, 1}), 2 * Mat3::Identity(), Vec3(10, 0, 0));
  EXPECT_EQ(bounds(mesh).min(), Vec3(9, -1, -1));
  EXPECT_EQ(bounds(mesh).max(), Vec3(11, 1, 1));
}

TEST(Mesh, ReflectionKeepsFacesOutward) {
  const TriangleMesh mesh = transformed(box({1, 2, 3}), Vec3(1, -1, 1).asDiagonal(), Vec3::Zero());
  EXPECT_DOUBLE_EQ(mass_properties(mesh).volume, 6);
}

TEST(Mesh, SolidsAreClosedTwoManifolds) {
  for (const TriangleMesh& mesh :
       {box({1, 2, 3}), sphere(1, 3), torus(1, 0.3), hollow_sphere(1, 0.2, 2), cup(0.1, 0.006)})
    EXPECT_TRUE(is_closed_two_manifold(mesh));
}

TEST(Mesh, AnyDefectIsSeen) {
  EXPECT_FALSE(is_closed_two_manifold({}));
  TriangleMesh open = sphere(1, 2);
  open.faces.pop_back();
  EXPECT_FALSE(is_closed_two_manifold(open));
  TriangleMesh turned = sphere(1, 2);
  std::swap(turned.faces[7][0], turned.faces[7][1]);
  EXPECT_FALSE(is_closed_two_manifold(turned));
  TriangleMesh doubled = box({1, 1, 1});
  doubled.faces.insert(doubled.faces.end(), doubled.faces.begin(), doubled.faces.end());
  EXPECT_FALSE(is_closed_two_manifold(doubled));
}

TEST(Mesh, TwoSolidsThatShareAVertexAreNotAManifold) {
  TriangleMesh mesh = box({1, 1, 1});
  const TriangleMesh other = transformed(mesh, Mat3::Identity(), Vec3(1, 1, 1));
  const auto corner = [](const TriangleMesh& m, const Vec3& x) {
    return static_cast<int>(std::find(m.vertices.begin(), m.vertices.end(), x) - m.vertices.begin());
  };
  const int shared = corner(mesh, Vec3(0.5, 0.5, 0.5)), twin = corner(other, Vec3(0.5, 0.5, 0.5));
  const int first = static_cast<int>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), other.vertices.begin(), other.vertices.end());
  for (const auto& [a, b, c] : other.faces) mesh.faces.push_back({first + a, first + b, first + c});
  EXPECT_TRUE(is_closed_two_manifold(mesh)) << "two separate boxes are";
  for (Triangle& face : mesh.faces)
    for (int& v : face) v = v == first + twin ? shared : v;
  EXPECT_FALSE(is_closed_two_manifold(mesh));
}

}  // namespace
}  // namespace sunder::geometry
