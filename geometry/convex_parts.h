#pragma once
/// A solid as a few convex hulls, for collision.
#include <vector>

#include "geometry/mesh.h"

namespace sunder::geometry {

struct ConvexPartsSettings {
  int max_parts = 24;
  /// As a share of the solid's largest extent. A part is split while its hull closes a hollow deeper than this; half of
  /// it may stand out of a hull.
  double gap = 0.005;
  int max_hull_vertices = 64;  ///< per hull, at least 8; a round part may need more to keep the gap
};

struct ConvexParts {
  std::vector<TriangleMesh> hulls;  ///< convex, closed, outward; vertices are the solid's or lie on planes of a split
  double left_out = 0;              ///< the solid stands out of its hulls by no more than this [m]
  double bulge = 0;  ///< the hulls stand off the solid by about this at most, seen from sample points [m]
};

/// Splits the solid by planes, always the part whose hull holds most air, along the plane (of a few across the
/// principal axes of its surface) after which the hulls hold least; so a cup keeps its opening. Each part's hull is
/// that of the solid inside the part's cell. Hulls touch the solid from inside where vertices are left out and close
/// its hollows where parts are too few: the support of flat faces and corners is exact, a saddle costs many parts.
/// Voids and what lies in them are not asked for: nothing gets there. Deterministic. A solid whose vertices lie exactly
/// in one plane gives no hull; any other gives at least one, however thin.
///
/// Lien and Amato, "Approximate convex decomposition of polyhedra" (2007), with volumes in place of notches to choose
/// planes by: halves of a hollow save nothing until the second cut, which a notch does not tell and pairs of planes do.
ConvexParts convex_parts(const TriangleMesh& solid, const ConvexPartsSettings& settings = {});

}  // namespace sunder::geometry
