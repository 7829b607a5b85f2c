#pragma once
/// TriangleMesh <-> OpenVDB level sets. For .cpp files of this module only.
#include <openvdb/openvdb.h>

#include "geometry/mesh.h"

namespace sunder::geometry::detail {

constexpr float half_band = 3;  ///< half width of narrow bands in voxels

/// Has to come before anything else of OpenVDB; any number of times.
void initialize_openvdb();

/// A mesh in voxels, in the form that OpenVDB reads.
struct VoxelMesh {
  const TriangleMesh& mesh;
  Vec3 origin;   ///< of the voxels [m]
  double voxel;  ///< [m]

  std::size_t polygonCount() const { return mesh.faces.size(); }
  std::size_t pointCount() const { return mesh.vertices.size(); }
  std::size_t vertexCount(std::size_t) const { return 3; }
  void getIndexSpacePoint(std::size_t face, std::size_t corner, openvdb::Vec3d& point) const {
    const Vec3 x = (mesh.vertices[mesh.faces[face][corner]] - origin) / voxel;
    point = {x.x(), x.y(), x.z()};
  }
};

/// The zero surface of a level set (dual contouring on a uniform grid), faces outward.
TriangleMesh surface_of(const openvdb::FloatGrid& grid, const Vec3& origin, double voxel);

}  // namespace sunder::geometry::detail
