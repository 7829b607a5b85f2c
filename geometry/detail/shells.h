#pragma once
/// Surfaces of several shells.
#include <array>
#include <vector>

#include "geometry/mesh.h"

namespace sunder::geometry::detail {

/// Per face and per edge (corner k to corner k + 1) the face on the other side.
/// Errors: ErrorKind::mesh unless every edge has exactly two faces, which pass it in opposite directions.
std::vector<std::array<int, 3>> face_neighbours(const TriangleMesh& mesh);

/// Keeps the vertices that faces use, in order of first use.
TriangleMesh compact(const std::vector<Vec3>& vertices, const std::vector<Triangle>& faces);

/// Per shell the smallest outer shell (of positive volume) around it if it is a void (negative volume), itself
/// otherwise. Shells must not cross. Errors: ErrorKind::mesh when a void has no shell around it or a shell has no
/// volume.
std::vector<int> owners(const std::vector<const TriangleMesh*>& shells);

}  // namespace sunder::geometry::detail
