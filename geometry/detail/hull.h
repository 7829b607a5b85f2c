#pragma once
/// Convex hulls with few vertices.
#include <vector>

#include "geometry/mesh.h"

namespace sunder::geometry::detail {

/// Columns: unit vectors spread evenly over the sphere (Fibonacci lattice: Gonzalez, "Measurement of areas on a sphere
/// using Fibonacci and latitude-longitude lattices", 2010).
Eigen::Matrix3Xd even_directions(int count);

/// The hull of all points, outward, with exact predicates; empty when they lie in one plane. Meant for at most a few
/// hundred points: the time grows with their square.
TriangleMesh convex_hull(const std::vector<Vec3>& points);

/// The volume of the same in rounded arithmetic, to rank candidates.
double rough_hull_volume(const std::vector<Vec3>& points);

struct SmallHull {
  TriangleMesh mesh;  ///< empty when the points lie in one plane
  double full_volume =
      0;  ///< of the hull before vertices were left out, itself of points far along even directions [m^3]
};

/// A hull with at most `max_vertices` of the points: exact if that many are enough, else of the points farthest along
/// even directions in a frame that makes the points about as wide as they are long.
SmallHull small_convex_hull(const std::vector<Vec3>& points, int max_vertices);

/// Principal axes of the points (columns), right-handed. The identity for fewer than two points.
Mat3 principal_axes(const std::vector<Vec3>& points);

double volume(const TriangleMesh& mesh);

}  // namespace sunder::geometry::detail
