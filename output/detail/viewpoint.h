#pragma once
/// Where to look from.
#include <vector>

#include "output/detail/camera.h"
#include "output/detail/ray_scene.h"

namespace sunder::output::detail {

/// Of four three-quarter views of the subject's long side, or of the side towards +Z, the one in which most of its
/// surface is seen, largest; of nearly equal ones the first, from the front right. The lower the subject, the more from
/// above. `points` are its vertices, `samples` random points of its surface. Neither may be empty.
Camera viewpoint(const RayScene& scene, std::span<const Vec3> points, std::span<const Vec3> samples, double aspect,
                 double fill);

}  // namespace sunder::output::detail
