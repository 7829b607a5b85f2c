#pragma once
/// Crushed lumps: how much there is, and cells to subdivide it.
#include <cstdint>
#include <vector>

#include "crack/detail/nearest.h"

namespace sunder::crack::detail {

/// Crack nodes, and how far they are from sound ones.
struct Crushed {
  std::vector<char> sound;  ///< per node
  Nearest to_sound;         ///< per position of the lattice
  /// Squared distance in spacings to the nearest sound node; the largest number if there is none.
  int squared_depth(const Lattice& lattice, int node) const;
};

Crushed find_crushed(const Raster& raster, double crack_damage);

/// Nodes farther than `depth` spacings from every sound one / nodes.
double lump_share(const Lattice& lattice, const Crushed& crushed, double depth);

/// Nodes in lumps, at least `size` spacings from each other and half of it from sound nodes: as many as there is room
/// for, in an order drawn by `seed` (Poisson-disk sampling by throwing darts at nodes). Their Voronoi cells subdivide
/// the lumps.
std::vector<int> debris_seeds(const Lattice& lattice, const Crushed& crushed, double size, std::uint64_t seed);

}  // namespace sunder::crack::detail
