#pragma once
/// Whether triangles have nothing in common but the vertices and edges that they share.
#include "geometry/detail/arrangement.h"
#include "geometry/detail/box_tree.h"
#include "geometry/detail/crack_complex.h"

namespace sunder::geometry::detail {

/// Of all pairs of faces. Exact, in parallel.
bool intersects_itself(const TriangleMesh& mesh, const BoxTree& tree);

/// Per face whether it meets another one so. Exact, in parallel.
std::vector<char> meeting_faces(const TriangleMesh& mesh, const BoxTree& tree);

/// Of the rounded parts that the cut made, against each other and against the faces of the body that it left alone.
/// `tree` holds the faces of the body, which must not intersect each other. Parts of one face of the body or of one
/// plane region face are known to be apart, as none of them is turned. Errors: ErrorKind::mesh when two parts meet, or
/// when a part has no area.
void require_embedded(const Arrangement& arrangement, const CrackComplex& complex, const BoxTree& tree,
                      const std::vector<char>& is_inside);

}  // namespace sunder::geometry::detail
