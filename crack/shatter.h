#pragma once
/// A plain Voronoi shatter: what breaks without physics, as a baseline and for tests.
#include <cstdint>

#include "core/progress.h"
#include "geometry/cut.h"

namespace sunder::crack {

/// The Voronoi cells of `sites` [m] in `domain` enlarged by a tenth of its diagonal; region i is the cell of site i.
/// Sites are jittered by 1e-6 of the diagonal by their index and `seed`, so that lattices are fine. Errors:
/// ErrorKind::internal when the cells do not fit together after repeated jitter.
geometry::RegionBoundary voronoi_cells(const std::vector<Vec3>& sites, const Box& domain, std::uint64_t seed,
                                       Progress& progress);

}  // namespace sunder::crack
