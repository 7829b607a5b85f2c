#include "geometry/detail/vdb_mesh.h"

#include <mutex>

#include <openvdb/tools/VolumeToMesh.h>

namespace sunder::geometry::detail {

void initialize_openvdb() {
  static std::once_flag once;
  std::call_once(once, [] { openvdb::initialize(); });
}

TriangleMesh surface_of(const openvdb::FloatGrid& grid, const Vec3& origin, double voxel) {
  std::vector<openvdb::Vec3s> points;
  std::vector<openvdb::Vec4I> quads;
  openvdb::tools::volumeToMesh(grid, points, quads);
  TriangleMesh result;
  for (const auto& x : points) result.vertices.push_back(origin + voxel * Vec3(x.x(), x.y(), x.z()));
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
