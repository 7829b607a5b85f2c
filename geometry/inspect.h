#pragma once
/// What is wrong with a mesh, if anything.
#include <string>

#include "geometry/mesh.h"

namespace sunder::geometry {

/// Counts of defects; a solid has none (`is_solid`).
struct MeshReport {
  int vertices = 0, faces = 0;
  int shells = 0;                 ///< connected components of faces
  int boundary_edges = 0;         ///< edges with one face
  int boundary_loops = 0;         ///< holes
  int non_manifold_edges = 0;     ///< edges with more than two faces, or two that turn the same way
  int non_manifold_vertices = 0;  ///< vertices where several fans of faces meet
  int bad_vertices = 0;           ///< vertices whose position is not finite
  int degenerate_faces = 0;       ///< faces of zero area, or that name a vertex twice or one that does not exist
  int self_intersections =
      0;  ///< pairs of faces that cross; -1 when not checked (the mesh is not a triangle surface yet)
  int duplicate_vertices = 0;  ///< vertices at the position of an earlier one
  int nested_shells = 0;       ///< closed shells inside an odd number of others: voids; 0 while shells cross
  int inverted_shells = 0;     ///< closed shells that point the wrong way for their nesting; 0 while shells cross
  double volume = 0;           ///< signed [m^3]
  Box box;

  /// Closed, manifold, free of self-intersections, outward oriented, with positive volume: what `cut` and `sample`
  /// require.
  bool is_solid() const;

  /// "open: 12 boundary edges in 2 holes; 3 self-intersections" or "closed solid".
  std::string summary() const;
};

/// Never throws on a broken mesh: a broken mesh is the answer.
MeshReport inspect(const TriangleMesh& mesh);

}  // namespace sunder::geometry
