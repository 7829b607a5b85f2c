#pragma once
/// How round, long and flat a solid is.
#include <optional>

#include "geometry/mass_properties.h"

namespace sunder::geometry {

/// Of the ellipsoid with the solid's volume moments: semi-axes sqrt(5 l) for the eigenvalues l of the solid's second
/// moment over its volume. It is defined for every solid and turns with it, which a bounding box does only where it is
/// the smallest one, and of a box or an ellipsoid the ratios are those of the sides. The ratios are the inverses of
/// Zingg's (1935; Blott, Pye, "Particle shape: a review and new methods", Sedimentology 55, 2008), so that they grow
/// with what they are named after.
struct ShapeMeasures {
  double sphericity = 0;     ///< pi^(1/3) (6 V)^(2/3) / A, in (0, 1] (Wadell 1935): a sphere 1, a cube 0.81
  double elongation = 0;     ///< length over width, at least 1
  double flatness = 0;       ///< width over thickness, at least 1
  Vec3 axes = Vec3::Zero();  ///< length, width and thickness: full axes of the ellipsoid [m]
};

/// Not set for what has no positive volume and second moments: no closed solid, or one that is inside out.
std::optional<ShapeMeasures> shape_measures(const MassProperties& mass);

}  // namespace sunder::geometry
