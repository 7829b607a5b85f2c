#include "geometry/detail/level_sets.h"

#include <openvdb/tools/MeshToVolume.h>

#include "geometry/detail/vdb_mesh.h"

namespace sunder::geometry::detail {
namespace {

openvdb::Coord coord(const Lattice& lattice, int index) {
  return {index % lattice.count[0], index / lattice.count[0] % lattice.count[1],
          index / lattice.count[0] / lattice.count[1]};
}

}  // namespace

struct BodyLevelSet::Grids {
  openvdb::FloatGrid::Ptr distance;
  openvdb::Int32Grid face{-1};  // nearest face of every voxel of the band
};

BodyLevelSet::BodyLevelSet(const TriangleMesh& body, const Lattice& lattice)
    : lattice_(lattice), grids_(std::make_unique<Grids>()) {
  initialize_openvdb();
  const auto unit = openvdb::math::Transform::createLinearTransform(1.0);
  grids_->distance = openvdb::tools::meshToVolume<openvdb::FloatGrid>(
      VoxelMesh{body, lattice_.origin, lattice_.spacing}, *unit, half_band, half_band, 0, &grids_->face);
}

BodyLevelSet::~BodyLevelSet() = default;

std::vector<char> BodyLevelSet::near_or_inside() const {
  std::vector<char> result(lattice_.size());
  auto distance = grids_->distance->getConstAccessor();
  for (int i = 0; i < lattice_.size(); ++i) result[i] = distance.getValue(coord(lattice_, i)) < half_band;
  return result;
}

TriangleMesh BodyLevelSet::part_inside(const std::vector<int>& region_of_point, int region,
                                       const TriangleMesh& walls) const {
  const auto unit = openvdb::math::Transform::createLinearTransform(1.0);
  openvdb::FloatGrid::Ptr from_walls = openvdb::FloatGrid::create(half_band);
  if (!walls.faces.empty()) {
    from_walls =
        openvdb::tools::meshToVolume<openvdb::FloatGrid>(VoxelMesh{walls, lattice_.origin, lattice_.spacing}, *unit,
                                                         half_band, half_band, openvdb::tools::UNSIGNED_DISTANCE_FIELD);
  }
  const auto part = openvdb::FloatGrid::create(half_band);
  part->setGridClass(openvdb::GRID_LEVEL_SET);  // decides which way faces turn
  auto body = grids_->distance->getConstAccessor();
  auto wall = from_walls->getConstAccessor();
  auto out = part->getAccessor();
  for (int i = 0; i < lattice_.size(); ++i) {
    if (region_of_point[i] < 0) continue;
    const openvdb::Coord at = coord(lattice_, i);
    const float to_wall = std::min(wall.getValue(at), half_band);
    const float value = std::max(body.getValue(at), region_of_point[i] == region ? -to_wall : to_wall);
    if (value < half_band) out.setValue(at, value);
  }
  return surface_of(*part, lattice_.origin, lattice_.spacing);
}

int BodyLevelSet::face_within_a_voxel(const Vec3& point) const {
  const Vec3 x = (point - lattice_.origin) / lattice_.spacing;
  const openvdb::Coord at = openvdb::Coord::round(openvdb::Vec3d(x.x(), x.y(), x.z()));
  // A voxel's centre is up to 0.87 voxels away from the point.
  if (std::abs(grids_->distance->tree().getValue(at)) > 1) return -1;
  return grids_->face.tree().getValue(at);
}

}  // namespace sunder::geometry::detail
