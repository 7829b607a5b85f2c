#include "geometry/detail/remesh.h"

#include <mutex>

#include <openvdb/openvdb.h>
#include <openvdb/tools/MeshToVolume.h>
#include <openvdb/tools/VolumeToMesh.h>

namespace sunder::geometry::detail {
namespace {

// Keeps the flat sides of boxes and plates off the voxel centres, where the surface would touch the grid and pinch.
const Vec3 kShift(0.31, 0.17, 0.43);
constexpr float kBand = 3;  // half width of the narrow band in voxels

/// The mesh in voxels, in the form that OpenVDB reads.
struct VoxelMesh {
  const TriangleMesh& mesh;
  Vec3 origin;
  double voxel;

  std::size_t polygonCount() const { return mesh.faces.size(); }
  std::size_t pointCount() const { return mesh.vertices.size(); }
  std::size_t vertexCount(std::size_t) const { return 3; }
  void getIndexSpacePoint(std::size_t face, std::size_t corner, openvdb::Vec3d& point) const {
    const Vec3 x = (mesh.vertices[mesh.faces[face][corner]] - origin) / voxel;
    point = {x.x(), x.y(), x.z()};
  }
};

void initialize_openvdb() {
  static std::once_flag once;
  std::call_once(once, [] { openvdb::initialize(); });
}

}  // namespace

TriangleMesh remeshed(const TriangleMesh& mesh, double voxel) {
  initialize_openvdb();
  const VoxelMesh input{mesh, bounds(mesh).center() + voxel * kShift, voxel};
  const auto unit = openvdb::math::Transform::createLinearTransform(1.0);
  const auto grid = openvdb::tools::meshToVolume<openvdb::FloatGrid>(input, *unit, kBand, kBand);
  std::vector<openvdb::Vec3s> points;
  std::vector<openvdb::Vec4I> quads;
  openvdb::tools::volumeToMesh(*grid, points, quads);
  TriangleMesh result;
  for (const auto& point : points)
    result.vertices.push_back(input.origin + voxel * Vec3(point.x(), point.y(), point.z()));
  for (const auto& quad : quads) {
    const int a = static_cast<int>(quad[0]), b = static_cast<int>(quad[1]);
    const int c = static_cast<int>(quad[2]), d = static_cast<int>(quad[3]);
    // OpenVDB turns its polygons clockwise.
    result.faces.push_back({a, c, b});
    result.faces.push_back({a, d, c});
  }
  return result;
}

}  // namespace sunder::geometry::detail
