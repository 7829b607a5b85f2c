#pragma once
/// A solid as a few convex hulls, for collision.
#include <vector>

#include "geometry/mesh.h"

namespace sunder::geometry {

struct ConvexPartsSettings {
  int max_parts = 24;
  double excess = 0.04;        ///< stop when the parts' hulls hold at most this share more volume than the solid
  int max_hull_vertices = 64;  ///< per hull, at least 8
};

struct ConvexParts {
  std::vector<TriangleMesh>
      hulls;          ///< convex, closed, outward; together they cover the solid (up to vertex decimation)
  double excess = 0;  ///< (sum of hull volumes - solid volume) / solid volume; negative where leaving out
                      ///< vertices of a round part costs more than its hull adds
};

/// Splits the solid by planes, always the part with the largest excess volume, along the plane that lowers the sum of
/// hull volumes most (of a few across its principal axes, rather near the middle of a long one). Each part's hull is
/// that of the solid inside the part's cell, so a cup keeps its opening. Deterministic. A solid whose vertices lie
/// exactly in one plane gives no hull; any other gives at least one, however thin.
ConvexParts convex_parts(const TriangleMesh& solid, const ConvexPartsSettings& settings = {});

}  // namespace sunder::geometry
