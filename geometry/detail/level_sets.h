#pragma once
/// The body as a signed distance on a lattice.
#include <memory>
#include <vector>

#include "geometry/detail/voxel_regions.h"

namespace sunder::geometry::detail {

class BodyLevelSet {
 public:
  BodyLevelSet(const TriangleMesh& body, const Lattice& lattice);
  ~BodyLevelSet();

  /// Per lattice point: inside the body or within its narrow band.
  std::vector<char> near_or_inside() const;

  /// The surface of the part of the body that lies in one region. `walls`: the faces that bound the region.
  TriangleMesh part_inside(const std::vector<int>& region_of_point, int region, const TriangleMesh& walls) const;

  /// The nearest face of the body, -1 if it is farther than a voxel.
  int face_within_a_voxel(const Vec3& point) const;

 private:
  struct Grids;

  Lattice lattice_;
  std::unique_ptr<Grids> grids_;
};

}  // namespace sunder::geometry::detail
