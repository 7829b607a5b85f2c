#pragma once
/// TriangleMesh <-> CGAL. For .cpp files of this module only.
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Surface_mesh.h>

#include "geometry/mesh.h"

namespace sunder::geometry::detail {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using SurfaceMesh = CGAL::Surface_mesh<Kernel::Point_3>;

inline Kernel::Point_3 to_point(const Vec3& x) { return {x.x(), x.y(), x.z()}; }
inline Vec3 to_vec3(const Kernel::Point_3& x) { return {x.x(), x.y(), x.z()}; }

/// Vertex and face i become descriptor i; vertices that no face uses stay, isolated.
/// Errors: ErrorKind::mesh when the faces are not an oriented manifold surface.
SurfaceMesh to_cgal(const TriangleMesh& mesh);

/// Removed elements and isolated vertices are left out; the order of what remains is kept. All faces must be triangles.
TriangleMesh from_cgal(const SurfaceMesh& mesh);

}  // namespace sunder::geometry::detail
