#pragma once
/// What becomes of a body by its share of the volume of the scene's body it comes from (Fan 2024, 3.6.3).
#include "geometry/convex_parts.h"
#include "pipeline/scene.h"

namespace sunder::pipeline {

enum class SizeClass {
  tiny,   ///< collides as its convex hull, or a few if it is curved; does not break unless `minimum_volume` says so
  small,  ///< collides as up to ten hulls
  large,  ///< collides as up to twenty
  nearly_whole,  ///< keeps the particles of the body that it is nearly the whole of
};

/// `share` in [0, 1]. Fan lets small fragments stay whole too; here `minimum_volume` alone decides what may break.
SizeClass size_class(double share, const FractureSettings& settings);

/// "tiny", "small", "large", "nearly whole".
const char* name_of(SizeClass size);

/// How closely a body of this class collides.
geometry::ConvexPartsSettings collision_detail(SizeClass size);

/// Share of the original volume under which a body does not break.
double minimum_volume(const FractureSettings& settings);

}  // namespace sunder::pipeline
