#pragma once
/// Triangles that cross each other.
#include <utility>
#include <vector>

#include "crack/detail/refine.h"

namespace sunder::crack::detail {

/// Pairs (lower, higher) of triangles that cross, ascending; only those of which at least one has `moved`, and none
/// that share an edge (they can only cross by folding onto each other). Triangles without area cross nothing.
/// `positions` replace the vertices of the mesh.
std::vector<std::pair<int, int>> crossings(const FineMesh& mesh, const std::vector<Vec3>& positions,
                                           const std::vector<char>& moved);

}  // namespace sunder::crack::detail
