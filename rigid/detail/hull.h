#pragma once
/// One convex part of a body, ready for collision.
#include <memory>
#include <optional>
#include <vector>

#include <btBulletCollisionCommon.h>

#include "core/types.h"
#include "geometry/mesh.h"

namespace sunder::rigid::detail {

struct HullFace {
  Vec3 normal = Vec3::Zero();  ///< unit, outward
  double offset = 0;           ///< the hull lies in normal . x <= offset [m]
  std::vector<int> loop;       ///< point indices, counter-clockwise seen from outside
};

struct Hull {
  std::vector<Vec3> points;                  ///< corners only [m]
  std::vector<HullFace> faces;               ///< coplanar faces merged
  Vec3 middle = Vec3::Zero();                ///< of the bounding box [m]
  double radius = 0;                         ///< half the diagonal of the bounding box [m]
  double thickness = 0;                      ///< smallest width over all face normals [m]
  std::unique_ptr<btConvexHullShape> shape;  ///< the same points, margin 0
};

/// Convex hull of the mesh's vertices, each mapped by x -> linear * x. Nothing if it has no volume.
std::optional<Hull> make_hull(const geometry::TriangleMesh& mesh, const Mat3& linear);

}  // namespace sunder::rigid::detail
