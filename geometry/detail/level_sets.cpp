#include "geometry/detail/level_sets.h"

#include <mutex>

#include <openvdb/openvdb.h>
#include <openvdb/tools/MeshToVolume.h>
#include <openvdb/tools/VolumeToMesh.h>

namespace sunder::geometry::detail {
namespace {

constexpr float kBand = 3;  // half width of the narrow band in voxels

/// A mesh in voxels, in the form that OpenVDB reads.
struct VoxelMesh {
  const TriangleMesh& mesh;
  const Lattice& lattice;

  std::size_t polygonCount() const { return mesh.faces.size(); }
  std::size_t pointCount() const { return mesh.vertices.size(); }
  std::size_t vertexCount(std::size_t) const { return 3; }
  void getIndexSpacePoint(std::size_t face, std::size_t corner, openvdb::Vec3d& point) const {
    const Vec3 x = (mesh.vertices[mesh.faces[face][corner]] - lattice.origin) / lattice.spacing;
    point = {x.x(), x.y(), x.z()};
  }
};

openvdb::Coord coord(const Lattice& lattice, int index) {
  return {index % lattice.count[0], index / lattice.count[0] % lattice.count[1],
          index / lattice.count[0] / lattice.count[1]};
}

TriangleMesh surface_of(const openvdb::FloatGrid& grid, const Lattice& lattice) {
  std::vector<openvdb::Vec3s> points;
  std::vector<openvdb::Vec4I> quads;
  openvdb::tools::volumeToMesh(grid, points, quads);
  TriangleMesh result;
  for (const auto& x : points) result.vertices.push_back(lattice.origin + lattice.spacing * Vec3(x.x(), x.y(), x.z()));
  for (const auto& quad : quads) {
    const int a = static_cast<int>(quad[0]), b = static_cast<int>(quad[1]);
    const int c = static_cast<int>(quad[2]), d = static_cast<int>(quad[3]);
    // OpenVDB turns its polygons clockwise.
    result.faces.push_back({a, c, b});
    result.faces.push_back({a, d, c});
  }
  return result;
}

}  // namespace

struct BodyLevelSet::Grids {
  openvdb::FloatGrid::Ptr distance;
  openvdb::Int32Grid face{-1};  // nearest face of every voxel of the band
};

BodyLevelSet::BodyLevelSet(const TriangleMesh& body, const Lattice& lattice)
    : lattice_(lattice), grids_(std::make_unique<Grids>()) {
  static std::once_flag once;
  std::call_once(once, [] { openvdb::initialize(); });
  const auto unit = openvdb::math::Transform::createLinearTransform(1.0);
  grids_->distance = openvdb::tools::meshToVolume<openvdb::FloatGrid>(VoxelMesh{body, lattice_}, *unit, kBand, kBand, 0,
                                                                      &grids_->face);
}

BodyLevelSet::~BodyLevelSet() = default;

std::vector<char> BodyLevelSet::near_or_inside() const {
  std::vector<char> result(lattice_.size());
  auto distance = grids_->distance->getConstAccessor();
  for (int i = 0; i < lattice_.size(); ++i) result[i] = distance.getValue(coord(lattice_, i)) < kBand;
  return result;
}

TriangleMesh BodyLevelSet::part_inside(const std::vector<int>& region_of_point, int region,
                                       const TriangleMesh& walls) const {
  const auto unit = openvdb::math::Transform::createLinearTransform(1.0);
  openvdb::FloatGrid::Ptr from_walls = openvdb::FloatGrid::create(kBand);
  if (!walls.faces.empty()) {
    from_walls = openvdb::tools::meshToVolume<openvdb::FloatGrid>(VoxelMesh{walls, lattice_}, *unit, kBand, kBand,
                                                                  openvdb::tools::UNSIGNED_DISTANCE_FIELD);
  }
  const auto part = openvdb::FloatGrid::create(kBand);
  part->setGridClass(openvdb::GRID_LEVEL_SET);  // decides which way faces turn
  auto body = grids_->distance->getConstAccessor();
  auto wall = from_walls->getConstAccessor();
  auto out = part->getAccessor();
  for (int i = 0; i < lattice_.size(); ++i) {
    if (region_of_point[i] < 0) continue;
    const openvdb::Coord at = coord(lattice_, i);
    const float to_wall = std::min(wall.getValue(at), kBand);
    const float value = std::max(body.getValue(at), region_of_point[i] == region ? -to_wall : to_wall);
    if (value < kBand) out.setValue(at, value);
  }
  return surface_of(*part, lattice_);
}

int BodyLevelSet::face_within_a_voxel(const Vec3& point) const {
  const Vec3 x = (point - lattice_.origin) / lattice_.spacing;
  const openvdb::Coord at = openvdb::Coord::round(openvdb::Vec3d(x.x(), x.y(), x.z()));
  // A voxel's centre is up to 0.87 voxels away from the point.
  if (std::abs(grids_->distance->tree().getValue(at)) > 1) return -1;
  return grids_->face.tree().getValue(at);
}

}  // namespace sunder::geometry::detail
