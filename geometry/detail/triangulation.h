#pragma once
/// A triangle divided along the segments in which others cross it.
#include <array>
#include <vector>

#include "geometry/detail/points.h"
#include "geometry/mesh.h"

namespace sunder::geometry::detail {

/// A segment inside the triangle, from point to point, by number.
struct Barrier {
  int start, end;
  int number;
};

/// Input: what divides one triangle. All points lie in its plane.
struct Division {
  Triangle corners;
  std::array<std::vector<int>, 3> on_edge;  // points between corner k and corner k + 1, in this order
  std::vector<int> inside;                  // points inside, in any order
  std::vector<Barrier> barriers;            // have no point in common but their ends
};

/// The cells on both sides of a barrier.
struct BarrierCells {
  int number;
  int left, right;  // looking from start to end
};

/// Output: parts of the triangle, turned like it. Cells are what the barriers separate.
struct Patch {
  std::vector<Triangle> faces;
  std::vector<int> cell;  // per face
  int cells = 0;
  std::vector<int> rim;            // the cells along edge 0, then edge 1, then edge 2, between point and point
  std::array<int, 3> first_rim{};  // where each edge starts in it
  std::vector<BarrierCells> barriers;
};

/// Constrained triangulation, Delaunay in the plane of the triangle up to rounding. All decisions that validity depends
/// on are exact. Errors: ErrorKind::mesh when barriers cross or pass through points, when two points coincide, and when
/// rounding of the points would turn or flatten a part.
Patch divide(const Points& points, const Division& division);

}  // namespace sunder::geometry::detail
