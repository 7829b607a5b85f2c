#pragma once
/// Where the faces of a body and the triangles of cracks cross.
#include <vector>

#include "geometry/detail/box_tree.h"
#include "geometry/detail/edges.h"
#include "geometry/detail/points.h"

namespace sunder::geometry::detail {

/// Triangles over common points.
struct Surface {
  std::vector<Triangle> faces;
  Edges edges;
};

/// What a face of the body and a crack triangle have in common. It runs along (normal of the face) x (normal of the
/// triangle): on its left the face lies behind the triangle, and the triangle in front of the face.
struct Segment {
  int face, triangle;
  int start, end;  // nodes
};

/// Lists of integers, one after the other.
struct Lists {
  std::vector<int> first;  // one more than there are lists
  std::vector<int> items;

  const int* begin(int list) const { return items.data() + first[list]; }
  const int* end(int list) const { return items.data() + first[list + 1]; }
  int size(int list) const { return first[list + 1] - first[list]; }
};

struct Crossings {
  std::vector<Node> nodes;  // node i is point input_count + i
  std::vector<Segment> segments;
  Lists on_body_edge, on_crack_edge;  // nodes, not sorted
  Lists on_face, on_triangle;         // segments
};

/// Decided by exact signs on input coordinates. `tree` holds the faces of the body. Independent of the number of
/// threads. Errors: ErrorKind::mesh when the surfaces touch without crossing (a vertex on a face, an edge on an edge).
Crossings find_crossings(const std::vector<Vec3>& inputs, const Surface& body, const BoxTree& tree,
                         const Surface& cracks);

}  // namespace sunder::geometry::detail
