#pragma once
/// Damage as voxels, for programs that shade, scatter and emit from volumes.
#include <span>
#include <string>

#include "core/types.h"
#include "geometry/mesh.h"

namespace sunder::geometry {

/// Points of a body with what happened to them.
struct DamageSamples {
  std::span<const Vec3> points;         ///< [m]
  std::span<const double> damage;       ///< in [0, 1]
  std::span<const double> damage_time;  ///< when damage reached 1 [s]; negative: never
  double spacing = 0;                   ///< of the points, and edge of a voxel [m]
};

/// The bytes of an OpenVDB file with three float grids in world coordinates; voxels are cubes of the points' spacing
/// that are turned with the body:
/// * `surface`: level set of the intact body (signed distance, negative inside, a band of 3 voxels) [m];
/// * `damage`: fog volume, active in the body: the mean of the points around a voxel, weighted by the quadratic
///   B-spline of their distance along each axis;
/// * `damage_time` [s]: the same mean of the points that have one; active where there are any, background -1.
/// Active voxels lie inside the body or within half a voxel of its surface. Errors: ErrorKind::usage when the lists
/// differ in length or the spacing is not positive.
std::string damage_volume(const TriangleMesh& solid, const DamageSamples& samples, const Pose& pose);

}  // namespace sunder::geometry
