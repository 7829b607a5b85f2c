#pragma once
/// Cutting a solid by planes without making it a mesh again: enough for its volume and its hull.
#include <vector>

#include "geometry/mesh.h"

namespace sunder::geometry::detail {

struct Plane {
  Vec3 normal = Vec3::UnitX();
  double height = 0;  ///< the plane is normal . x = height

  double distance(const Vec3& x) const { return normal.dot(x) - height; }
};

/// The part of a solid inside a convex cell.
struct CellPart {
  std::vector<Vec3> vertices;     ///< those of the surface first
  int on_surface = 0;             ///< how many those are
  std::vector<Triangle> surface;  ///< of the solid, clipped to the cell
  /// Close the surface along the cell's planes, for volume integrals only: fans that may overlap, leave the solid and
  /// cancel each other.
  std::vector<Triangle> caps;
  std::vector<Plane> planes;  ///< the cell: all distances <= 0

  double volume() const;
};

struct Halves {
  CellPart below, above;
};

/// Below: distance <= 0, up to rounding. The volumes add up to the part's; vertices that no face uses are dropped.
Halves halve(const CellPart& part, const Plane& plane);

/// Corners of the cell: where three of its planes meet on the inner side of all others.
std::vector<Vec3> cell_corners(const std::vector<Plane>& planes);

}  // namespace sunder::geometry::detail
