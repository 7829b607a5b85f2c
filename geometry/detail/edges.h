#pragma once
/// Numbered edges of a set of triangles.
#include <array>
#include <vector>

#include "geometry/mesh.h"

namespace sunder::geometry::detail {

/// A side of a face, from corner `corner` to the next.
struct HalfEdge {
  int face, corner;
  bool forward;  // it runs from the edge's lower vertex to the higher one
};

struct Edges {
  std::vector<std::array<int, 2>> ends;     // lower and higher vertex
  std::vector<std::array<int, 3>> of_face;  // edge from corner k to corner k + 1
  std::vector<int> first;                   // per edge: where its half-edges start; one more at the end
  std::vector<HalfEdge> sides;              // by edge, then by face

  int count() const { return static_cast<int>(ends.size()); }
  const HalfEdge* begin(int edge) const { return sides.data() + first[edge]; }
  const HalfEdge* end(int edge) const { return sides.data() + first[edge + 1]; }
};

/// Any number of faces may share an edge. Linear time; edges are ordered by their vertices.
Edges edges_of(const std::vector<Triangle>& faces, int vertex_count);

}  // namespace sunder::geometry::detail
