#pragma once
/// Which piece every point belongs to: islands of sound points, and the flood from them over everything else.
#include <vector>

#include "core/types.h"
#include "crack/extract.h"

namespace sunder::crack::detail {

/// Which points lie within a radius of each other, as rows of a sparse matrix.
struct LinkGraph {
  std::vector<int> start;      ///< per point, and one more: its first entry in `neighbour`
  std::vector<int> neighbour;  ///< ascending within a point
};

LinkGraph link_graph(const std::vector<Vec3>& points, double radius);

/// Every point in one of `count` pieces.
struct Partition {
  int count = 0;                ///< 0: no island at all, then every point is in piece 0
  std::vector<int> piece;       ///< per point
  std::vector<char> is_island;  ///< per point
  std::vector<char> is_astray;  ///< per point: the island point nearest in a straight line is of another piece
  double effective_count = 1;   ///< 1 / sum of (share of the points)^2
};

/// Islands are components of `solid` points over links, with at least `smallest` points; pieces are numbered by their
/// lowest point. Every other point joins the piece whose island is nearest, coming along links: points hand on the
/// island points that they were reached from, of up to three pieces, in the order of the straight distances to them,
/// which never decrease along the way (a vector distance transform after Danielsson (1980), on a graph). So distances
/// are Euclidean where the body is in the way of nothing, and no piece reaches across empty space. Points that no link
/// reaches join the nearest island point in a straight line.
Partition partition(const std::vector<Vec3>& points, const LinkGraph& links, const std::vector<char>& solid,
                    int smallest, double spacing);

}  // namespace sunder::crack::detail
