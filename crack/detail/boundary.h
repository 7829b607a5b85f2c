#pragma once
/// Faces between cells become the boundaries of regions, and a gate that they are closed.
#include "crack/detail/cells.h"
#include "geometry/cut.h"

namespace sunder::crack::detail {

/// Medial faces first, in the order of `cells.faces`, then those on the walls.
geometry::RegionBoundary region_boundary(const std::vector<Site>& sites, const CellFaces& cells, int region_count);

/// Every directed edge of a region's faces occurs once, and so does its opposite.
bool is_closed(const geometry::RegionBoundary& boundary);

}  // namespace sunder::crack::detail
