#include "mpm/material.h"

#include <cmath>

namespace sunder::mpm {

double Material::p_wave_speed() const { return std::sqrt((lame_lambda() + 2 * shear_modulus()) / density); }

}  // namespace sunder::mpm
