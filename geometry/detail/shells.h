#pragma once
/// Surfaces of several shells, and the solids that they bound.
#include <array>
#include <vector>

#include "geometry/mesh.h"

namespace sunder::geometry::detail {

/// Faces with provenance: any number of shells.
struct Piece {
  TriangleMesh mesh;
  std::vector<int> source;  // per face
};

/// Per face and per edge (corner k to corner k + 1) the face on the other side.
/// Errors: ErrorKind::mesh unless every edge has exactly two faces, which pass it in opposite directions.
std::vector<std::array<int, 3>> face_neighbours(const TriangleMesh& mesh);

/// Keeps the vertices that faces use, in order of first use.
TriangleMesh compact(const std::vector<Vec3>& vertices, const std::vector<Triangle>& faces);

/// Splits a closed surface into solids: each outer shell (positive volume) with the voids (negative volume) in it; a
/// void belongs to the smallest outer shell around it. Solids are ordered by their lexicographically lowest vertex.
/// Shells must not cross. Errors: ErrorKind::mesh when the surface is not closed and manifold, a void has no shell
/// around it or a shell has no volume.
std::vector<Piece> solids(const Piece& surface);

}  // namespace sunder::geometry::detail
