#include "geometry/detail/level_sets.h"

#include "geometry/detail/vdb_mesh.h"

namespace sunder::geometry::detail {
namespace {

openvdb::Coord coord(const Lattice& lattice, int index) {
  return {index % lattice.count[0], index / lattice.count[0] % lattice.count[1],
          index / lattice.count[0] / lattice.count[1]};
}

Voxels voxels_of(const Lattice& lattice) { return {lattice.origin, lattice.spacing}; }

}  // namespace

struct BodyLevelSet::Grids {
  openvdb::FloatGrid::Ptr distance;
  openvdb::Int32Grid face{-1};  // nearest face of every voxel of the band
};

BodyLevelSet::BodyLevelSet(const TriangleMesh& body, const Lattice& lattice)
    : lattice_(lattice), grids_(std::make_unique<Grids>()) {
  initialize_openvdb();
  grids_->distance = signed_distance(body, voxels_of(lattice_), 1, &grids_->face);
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
  const openvdb::FloatGrid::Ptr from_walls =
      walls.faces.empty() ? openvdb::FloatGrid::create(half_band) : unsigned_distance(walls, voxels_of(lattice_));
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
  return surface_of(*part, voxels_of(lattice_));
}

int BodyLevelSet::face_within_a_voxel(const Vec3& point) const {
  const Vec3 x = (point - lattice_.origin) / lattice_.spacing;
  const openvdb::Coord at = openvdb::Coord::round(openvdb::Vec3d(x.x(), x.y(), x.z()));
  // A voxel's centre is up to 0.87 voxels away from the point.
  if (std::abs(grids_->distance->tree().getValue(at)) > 1) return -1;
  return grids_->face.tree().getValue(at);
}

}  // namespace sunder::geometry::detail
