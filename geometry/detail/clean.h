#pragma once
/// Repairs of triangle soups: vertices and faces one by one, without neighbourhoods.
#include <string>
#include <vector>

#include "geometry/mesh.h"

namespace sunder::geometry::detail {

using Steps = std::vector<std::string>;

/// "filled 1 hole", "filled 3 holes".
std::string step(const std::string& verb, std::size_t count, const std::string& one, const std::string& many);

/// Per vertex the lowest index among the vertices that chains of at most `tolerance` (0: equal positions) join it to.
std::vector<int> coincident(const std::vector<Vec3>& vertices, double tolerance);

bool names_a_vertex_twice(const Triangle& face);

/// Merges vertices that are at most `tolerance` apart (0: equal positions) into the one with the lowest index. Faces
/// that name a vertex twice afterwards are dropped.
TriangleMesh welded(const TriangleMesh& mesh, double tolerance);

/// Drops vertices that no face uses.
TriangleMesh compacted(const TriangleMesh& mesh);

/// Drops faces that cannot be used, welds, and drops repeated faces. Of two equal faces that turn opposite ways both
/// go: they are a wall inside the material; but when most of the mesh would vanish that way it is a two-sided surface
/// and one of each stays.
TriangleMesh cleaned(const TriangleMesh& mesh, Steps& steps);

}  // namespace sunder::geometry::detail
