#pragma once
/// Solids with fewer faces, for proxies and previews.
#include "geometry/mesh.h"

namespace sunder::geometry {

/// Collapses edges until at most `most_faces` faces are left, or no edge can be collapsed without changing the topology
/// or turning a face by a right angle or more: then `faces.size()` of the result says how far it came. The result is a
/// closed two-manifold with the shells and handles of the solid, and the same for the same input. A mesh that already
/// is within the budget comes back bit for bit.
///
/// Source: Lindstrom and Turk, "Fast and memory efficient polygonal simplification" (1998), by CGAL. Every collapse
/// keeps the volume, so the result has that of the solid up to rounding (1e-13 measured; quadrics after Garland and
/// Heckbert lose 1e-3 at a tenth of the faces and 1e-2 to 1e-1 at a hundredth). At coarse budgets thin parts may come
/// to cross each other: `inspect` tells. Errors: ErrorKind::usage for a budget below 4, ErrorKind::mesh when the mesh
/// is not closed and manifold.
TriangleMesh decimated(const TriangleMesh& solid, int most_faces);

}  // namespace sunder::geometry
