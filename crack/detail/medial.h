#pragma once
/// The medial faces between pieces, and the boundaries of the regions: jitters the sites until their cells fit
/// together.
#include <vector>

#include "core/progress.h"
#include "crack/detail/cells.h"
#include "geometry/cut.h"

namespace sunder::crack::detail {

struct MedialRequest {
  CellRequest cells;
  int pieces = 1;
  double jitter = 0;  ///< displacement of the sites along each axis [m]
  std::uint64_t seed = 1;
};

struct Medial {
  CellFaces cells;
  geometry::RegionBoundary boundary;
  int retries = 0;  ///< times the sites had to be jittered anew
};

/// Errors: ErrorKind::internal when cells do not fit together after repeated jitter.
Medial medial_faces(const std::vector<Site>& sites, const MedialRequest& request, Progress& progress);

}  // namespace sunder::crack::detail
