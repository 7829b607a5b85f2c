#pragma once
/// Points against a solid.
#include <vector>

#include "geometry/mesh.h"

namespace sunder::geometry {

enum class Side { outside, on, inside };

/// Per point where it lies, in parallel and decided with exact predicates, so `on` means on the surface without any
/// tolerance. Inside is what an odd number of faces lies above; the solid must be closed (it may touch itself).
std::vector<Side> side_of(const TriangleMesh& solid, const std::vector<Vec3>& points);

}  // namespace sunder::geometry
