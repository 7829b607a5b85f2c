#pragma once
/// How far points and surfaces are from a surface.
#include <span>
#include <vector>

#include "geometry/mesh.h"

namespace sunder::geometry {

struct SurfacePoint {
  int face = -1;
  Vec3 point = Vec3::Zero();  ///< the nearest of the surface [m]
  double distance = 0;        ///< [m]
};

/// For each point the nearest one of the surface, in parallel; of equally near faces any, the same in every call.
/// Faces without area are left out. Errors: ErrorKind::mesh when no face is left.
std::vector<SurfacePoint> nearest_on(const TriangleMesh& surface, std::span<const Vec3> points);

/// The largest distance of a vertex or face centre of one surface to the other, of both ways [m]: the Hausdorff
/// distance from below, and exact where surfaces differ by parts that are meshed. Errors: as nearest_on.
double hausdorff_distance(const TriangleMesh& a, const TriangleMesh& b);

}  // namespace sunder::geometry
