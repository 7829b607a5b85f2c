#pragma once
/// Which piece every node belongs to: islands of sound nodes, and the flood from them over everything else.
#include <vector>

#include "crack/detail/lattice.h"

namespace sunder::crack::detail {

/// Every node in one of `count` pieces.
struct Partition {
  int count = 0;                ///< 0: no island at all, then every node is in piece 0
  std::vector<int> piece;       ///< per node; before the flood only for nodes on islands
  std::vector<char> is_island;  ///< per node
  std::vector<int> reach;       ///< per node: squared distance in spacings that its piece came from, 0 on islands
};

struct IslandRequest {
  int smallest = 1;        ///< islands with fewer nodes are none
  std::vector<int> seeds;  ///< nodes that are islands of their own, whatever their size: debris
};

/// Islands are components of `solid` nodes over links, numbered by their lowest node, then the seeds.
Partition find_islands(const Lattice& lattice, const std::vector<char>& solid, const IslandRequest& request);

/// 1 / sum of squared shares of the islands in the nodes of all islands.
double effective_count(const Partition& partition);

/// Every other node joins the piece whose island is nearest, coming along links: nodes hand on the island nodes that
/// they were reached from, of up to three pieces, in the order of the straight distances to them, which never decrease
/// along the way (a vector distance transform after Danielsson (1980), on a graph). So distances are Euclidean where
/// nothing is in the way, and no piece reaches across empty space. Nodes that no link reaches join the nearest island
/// in a straight line.
void flood_from_islands(const Lattice& lattice, Partition& partition);

}  // namespace sunder::crack::detail
