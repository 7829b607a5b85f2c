#pragma once
/// Spatial scatter of the strength.
#include <cstdint>
#include <vector>

#include "core/types.h"

namespace sunder::mpm {

/// One factor of mean 1 per point, Weibull-distributed with the given modulus and smooth over `correlation_length` [m]:
/// a Gaussian field on a lattice of that spacing, blended by quadratic B-splines, mapped to the Weibull distribution.
/// Modulus 0 gives ones. A factor depends on (seed, position) only.
std::vector<double> strength_scatter(const std::vector<Vec3>& points, double weibull_modulus, double correlation_length,
                                     std::uint64_t seed);

}  // namespace sunder::mpm
