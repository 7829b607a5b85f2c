#pragma once
/// How the faces of a mesh hang together, for any set of triangles, however broken.
#include <vector>

#include "geometry/mesh.h"

namespace sunder::geometry::detail {

/// One side of a face: from corner `corner` of face `face` to the next corner.
struct Side {
  int low = 0, high = 0;  ///< its end vertices, low < high
  int face = 0, corner = 0;
  bool forward = false;  ///< the face walks it from low to high
};

/// All sides of the faces, those of one edge in a row, in a fixed order. Every face must name three different existing
/// vertices.
std::vector<Side> sorted_sides(const std::vector<Triangle>& faces);

/// Calls visit(first, last) for the range of sides of every edge.
template <class Visit>
void for_each_edge(const std::vector<Side>& sides, const Visit& visit) {
  for (auto first = sides.begin(); first != sides.end();) {
    auto last = first + 1;
    while (last != sides.end() && last->low == first->low && last->high == first->high) ++last;
    visit(first, last);
    first = last;
  }
}

/// Disjoint sets of 0 ... n-1.
class DisjointSets {
 public:
  explicit DisjointSets(int count);
  int find(int i);
  void unite(int i, int j);  ///< the smaller representative stays
  /// Per element the number of its set; sets are numbered by their first element.
  std::vector<int> labels();

 private:
  std::vector<int> parent_;
};

/// Per face the number of its connected component (across shared edges), numbered by first face.
std::vector<int> face_components(const std::vector<Triangle>& faces, const std::vector<Side>& sides);

/// The faces of each component as meshes of their own, without unused vertices.
std::vector<TriangleMesh> split(const TriangleMesh& mesh, const std::vector<int>& component);

}  // namespace sunder::geometry::detail
