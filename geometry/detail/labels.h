#pragma once
/// Which region, and which side of the body, the cells of an arrangement lie in.
#include <vector>

#include "geometry/detail/arrangement.h"
#include "geometry/detail/crack_complex.h"
#include "geometry/detail/topology.h"

namespace sunder::geometry::detail {

struct Labels {
  std::vector<int> region;      // per cell of the body
  std::vector<char> is_inside;  // per cell of the cracks: inside the body
  DisjointSets body_sets;       // cells of the body that hang together
};

/// The region of a point: by the first crack triangle that a segment from it meets; 0 if there is none at all.
/// Errors: ErrorKind::mesh when the point lies on a crack.
int region_at(const Vec3& point, const CrackComplex& cracks);

/// Per cell of the cracks. Errors: ErrorKind::mesh when segments contradict each other.
std::vector<char> crack_cells_inside(const Arrangement& arrangement, const TriangleMesh& body);

/// Parts of the body hold their region by the cracks that they touch; the others by the first crack triangle that a
/// segment from them meets, among all of `far`, which may reach beyond the cracks of the arrangement; region 0 if there
/// is none. Errors: ErrorKind::mesh when segments contradict each other.
Labels label(const Arrangement& arrangement, const CrackComplex& near, const CrackComplex& far,
             const std::vector<char>& is_inside);

}  // namespace sunder::geometry::detail
