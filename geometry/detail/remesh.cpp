#include "geometry/detail/remesh.h"

#include <openvdb/tools/MeshToVolume.h>

#include "geometry/detail/vdb_mesh.h"

namespace sunder::geometry::detail {
namespace {

// Keeps the flat sides of boxes and plates off the voxel centres, where the surface would touch the grid and pinch.
const Vec3 kShift(0.31, 0.17, 0.43);

}  // namespace

TriangleMesh remeshed(const TriangleMesh& mesh, double voxel) {
  initialize_openvdb();
  const VoxelMesh input{mesh, bounds(mesh).center() + voxel * kShift, voxel};
  const auto unit = openvdb::math::Transform::createLinearTransform(1.0);
  const auto grid = openvdb::tools::meshToVolume<openvdb::FloatGrid>(input, *unit, half_band, half_band);
  return surface_of(*grid, input.origin, voxel);
}

}  // namespace sunder::geometry::detail
