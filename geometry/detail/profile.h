#pragma once
/// Profiles for surfaces of revolution: polylines with rounded corners, and their offsets.
#include <vector>

#include "geometry/primitives.h"

namespace sunder::geometry::detail {

/// A corner of a polyline and the radius of the arc that rounds it; the arc shrinks when its neighbours leave no room.
struct Corner {
  double radius = 0, height = 0, fillet = 0;
};

/// The polyline with arcs in its corners, every straight piece divided into steps of at most `step`, every arc
/// into steps of at most half of it and turns of at most 15 degrees.
std::vector<ProfilePoint> rounded(const std::vector<Corner>& corners, double step);

/// The polyline moved to its left by `distance`, with arcs concentric to the given ones. It starts on the axis (radius
/// 0).
std::vector<Corner> offset_left(const std::vector<Corner>& corners, double distance);

}  // namespace sunder::geometry::detail
