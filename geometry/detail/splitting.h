#pragma once
/// Where to split a part of a solid so that the hulls of its halves hold less than its own.
#include <vector>

#include "geometry/detail/bulge.h"
#include "geometry/detail/halving.h"

namespace sunder::geometry::detail {

/// The plane after which the hulls hold least, of some across the principal axes of the surface and the planes of the
/// surface where the hull stands off it most. Where no plane saves much, as in a cup, whose halves hold as much air as
/// the whole: one of the pair of planes after which they do. `hull` is the part's, `points` are of its surface,
/// `bulges` as bulges() gives them. Hulls are estimated from these and a sample of the faces.
Plane splitting_plane(const CellPart& part, const TriangleMesh& hull, const std::vector<SurfacePoint>& points,
                      const std::vector<double>& bulges);

}  // namespace sunder::geometry::detail
