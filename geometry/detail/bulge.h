#pragma once
/// How far a hull stands off the surface it is the hull of.
#include <vector>

#include "geometry/mesh.h"

namespace sunder::geometry::detail {

struct SurfacePoint {
  Vec3 position, normal;  ///< the normal is outward, of length 1
};

/// About `count` points spread over the area of the faces. None for a surface without area.
std::vector<SurfacePoint> even_points(const std::vector<Vec3>& vertices, const std::vector<Triangle>& faces, int count);

/// Per point how far the hull stands off the surface over it, at most [m]: the distance of the nearest point from where
/// the way along the normal leaves the hull. So it is no more than what points so far apart can tell too much. Points
/// may stand out of the hull by `left_out` [m].
std::vector<double> bulges(const TriangleMesh& hull, const std::vector<SurfacePoint>& points, double left_out);

}  // namespace sunder::geometry::detail
