#include "geometry/detail/remesh.h"

#include "geometry/detail/vdb_mesh.h"

namespace sunder::geometry::detail {
namespace {

// Keeps the flat sides of boxes and plates off the voxel centres, where the surface would touch the grid and pinch.
const Vec3 kShift(0.31, 0.17, 0.43);

}  // namespace

TriangleMesh remeshed(const TriangleMesh& mesh, double voxel) {
  const Voxels voxels{bounds(mesh).center() + voxel * kShift, voxel};
  return surface_of(*signed_distance(mesh, voxels), voxels);
}

}  // namespace sunder::geometry::detail
