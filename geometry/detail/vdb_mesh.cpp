#include "geometry/detail/vdb_mesh.h"

#include <mutex>

#include <openvdb/tools/MeshToVolume.h>
#include <openvdb/tools/VolumeToMesh.h>

namespace sunder::geometry::detail {
namespace {

// Of the types that OpenVDB's library holds an instance for: minutes of compiling else.
openvdb::FloatGrid::Ptr distance(const TriangleMesh& mesh, const Voxels& voxels, double voxel_length, int flags,
                                 openvdb::Int32Grid* nearest) {
  initialize_openvdb();
  std::vector<openvdb::Vec3s> points;
  std::vector<openvdb::Vec3I> triangles;
  points.reserve(mesh.vertices.size());
  triangles.reserve(mesh.faces.size());
  for (const Vec3& vertex : mesh.vertices) {
    const Eigen::Vector3f x = ((vertex - voxels.origin) / voxels.size).cast<float>();
    points.emplace_back(x.x(), x.y(), x.z());
  }
  for (const auto& [a, b, c] : mesh.faces) triangles.emplace_back(a, b, c);
  const openvdb::tools::QuadAndTriangleDataAdapter<openvdb::Vec3s, openvdb::Vec3I> faces(points, triangles);
  const auto scale = openvdb::math::Transform::createLinearTransform(voxel_length);
  return openvdb::tools::meshToVolume<openvdb::FloatGrid>(faces, *scale, half_band, half_band, flags, nearest);
}

}  // namespace

void initialize_openvdb() {
  static std::once_flag once;
  std::call_once(once, [] { openvdb::initialize(); });
}

openvdb::FloatGrid::Ptr signed_distance(const TriangleMesh& mesh, const Voxels& voxels, double voxel_length,
                                        openvdb::Int32Grid* nearest) {
  return distance(mesh, voxels, voxel_length, 0, nearest);
}

openvdb::FloatGrid::Ptr unsigned_distance(const TriangleMesh& mesh, const Voxels& voxels) {
  return distance(mesh, voxels, 1, openvdb::tools::UNSIGNED_DISTANCE_FIELD, nullptr);
}

TriangleMesh surface_of(const openvdb::FloatGrid& grid, const Voxels& voxels) {
  std::vector<openvdb::Vec3s> points;
  std::vector<openvdb::Vec4I> quads;
  openvdb::tools::volumeToMesh(grid, points, quads);
  TriangleMesh result;
  for (const auto& x : points) result.vertices.push_back(voxels.origin + voxels.size * Vec3(x.x(), x.y(), x.z()));
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
