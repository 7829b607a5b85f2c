#pragma once
/// Which nodes own Voronoi cells, and where.
#include <vector>

#include "crack/detail/cells.h"
#include "crack/detail/islands.h"

namespace sunder::crack::detail {

struct SiteRequest {
  double crack_damage = 0.5;        ///< nodes at or above it are crack
  std::vector<int> seeds;           ///< nodes that are sites though they are crack: debris
  std::vector<Anchor> anchors;      ///< sites of an earlier extraction: they stay where they are
  std::vector<int> earlier_region;  ///< per piece: the region of the earlier extraction that it was part of
};

/// Sites are the sound nodes beside damage or beside another piece: no other node's cell can have a face on the medial
/// surface. Beside damage they leave the lattice for the iso-surface of the damage, so that the medial surface follows
/// the damage instead of the staircase of nodes. Behind them follow ever sparser nodes, which keep their cells small,
/// and those nodes whose nearest site would be another piece's: so that a crack in one limb never cuts another.
/// Fan (2024), table 3.1: these are the nodes V without the damaged ones; the sound side bounds the same region.
std::vector<Site> choose_sites(const Raster& raster, const Partition& pieces, const SiteRequest& request);

}  // namespace sunder::crack::detail
