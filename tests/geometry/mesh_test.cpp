#include "geometry/mesh.h"

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

}  // namespace
}  // namespace sunder::geometry
