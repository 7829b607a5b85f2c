#pragma once
/// Convex hulls with few vertices.
#include <vector>

#include "geometry/mesh.h"

namespace sunder::geometry::detail {

struct SmallHull {
  TriangleMesh mesh;    ///< convex, outward; empty when the points lie in one plane
  double left_out = 0;  ///< no point is farther from the mesh [m]
};

/// The hull of the points, grown from four of them by always adding the one farthest from it (with exact predicates)
/// until all lie within `tolerance` [m] or it has `max_vertices`, at least 4. The corners of a polyhedron come first,
/// so its flat sides stay flat. Its vertices are points, bit for bit.
SmallHull small_convex_hull(const std::vector<Vec3>& points, double tolerance, int max_vertices);

/// Principal axes of the points (columns), right-handed. The identity for fewer than two points.
Mat3 principal_axes(const std::vector<Vec3>& points);

double volume(const TriangleMesh& mesh);

}  // namespace sunder::geometry::detail
