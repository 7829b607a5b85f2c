#pragma once
/// Repairs of surfaces by CGAL's polygon mesh processing. Every function returns its input where it cannot help, and
/// adds to `steps` what it did.
#include "geometry/detail/clean.h"
#include "geometry/mesh.h"

namespace sunder::geometry::detail {

/// Turns neighbouring faces the same way and splits vertices and edges where more than two faces meet. Removes faces of
/// zero area.
TriangleMesh as_manifold(const TriangleMesh& mesh, Steps& steps);

/// Closes every hole of a manifold surface by a refined patch.
TriangleMesh with_holes_filled(const TriangleMesh& mesh, Steps& steps);

/// Removes self-intersections of a closed manifold surface: shells that cross only each other are united, the rest is
/// cut out and patched.
TriangleMesh without_crossings(const TriangleMesh& mesh, Steps& steps);

/// Turns the shells of a closed surface without self-intersections so that they bound a volume.
TriangleMesh outward(const TriangleMesh& mesh, Steps& steps);

}  // namespace sunder::geometry::detail
