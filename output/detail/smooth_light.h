#pragma once
/// Less noise for few rays.
#include "output/detail/render.h"

namespace sunder::output::detail {

/// Filters `light` within surfaces: the edge-avoiding wavelets of Dammertz et al. ("Edge-avoiding a-trous wavelet
/// transform for fast global illumination filtering", 2010), with weights by normal, by distance from the pixel's
/// tangent plane, and by difference in luminance against its standard deviation (Schied et al., "Spatiotemporal
/// variance-guided filtering", 2017, without what is temporal). Mixed pixels neither take part nor change. In parallel,
/// the same for any number of threads.
void smooth_light(std::vector<Pixel>& pixels, int width, int height);

}  // namespace sunder::output::detail
