#pragma once
/// Bodies that touch themselves.
#include "geometry/mesh.h"

namespace sunder::geometry::detail {

/// Whether two vertices that faces use have the same position.
bool has_coincident_vertices(const TriangleMesh& mesh);

/// A closed two-manifold whose coincident vertices are moved apart by about 1e-9 of its size: every fan of faces goes
/// to the side of it where there is less room, so fans that touch without crossing part. If that leaves faces that
/// meet, other directions are tried, the same ones every time. Errors: ErrorKind::mesh if no attempt gave a mesh
/// without self-intersections.
TriangleMesh moved_apart(const TriangleMesh& mesh);

}  // namespace sunder::geometry::detail
