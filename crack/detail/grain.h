#pragma once
/// Noise for the grain of a material.
#include "core/random.h"
#include "core/types.h"

namespace sunder::crack::detail {

/// Value noise in [0, 1] at a point: lattices of `size` and half of it, in turned axes, smoothly interpolated.
double grain_at(const Vec3& x, double size, std::uint64_t seed);

}  // namespace sunder::crack::detail
