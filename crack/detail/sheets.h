#pragma once
/// The sheets of a complex of triangles: what lies between two regions, between junctions.
#include <vector>

#include "crack/detail/refine.h"

namespace sunder::crack::detail {

/// Which vertices an edge joins, as rows of a sparse matrix.
struct EdgeGraph {
  std::vector<int> start;  ///< per vertex, and one more
  std::vector<int> neighbour;
};

struct Sheets {
  int count = 0;
  std::vector<int> of_face;    ///< per triangle
  std::vector<int> of_vertex;  ///< -1: must stay (on a junction, the hull, or too far away)
  std::vector<char> flipped;   ///< per triangle: it points from the higher region to the lower
  EdgeGraph edges;
};

/// Faces are of one sheet where they share an edge that has no third face and lie between the same two regions. A
/// vertex moves if all its faces are of one sheet, none of its edges is on a junction, and it lies in the box.
Sheets find_sheets(const geometry::RegionBoundary& boundary, const FineMesh& mesh, const Box& movable);

}  // namespace sunder::crack::detail
