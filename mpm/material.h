#pragma once
/// What a body is made of, as the solve needs it.
namespace sunder::mpm {

struct Material {
  double density = 0;           ///< [kg/m^3]
  double youngs_modulus = 0;    ///< E [Pa]
  double poisson_ratio = 0;     ///< nu in (-1, 0.5)
  double tensile_strength = 0;  ///< sigma_f [Pa]
  double fracture_energy = 0;   ///< G_f [J/m^2]
  double weibull_modulus = 0;   ///< scatter of the strength of virgin material; 0: none

  double shear_modulus() const { return youngs_modulus / (2 * (1 + poisson_ratio)); }
  double lame_lambda() const {
    return youngs_modulus * poisson_ratio / ((1 + poisson_ratio) * (1 - 2 * poisson_ratio));
  }
  /// Speed of pressure waves, sqrt((lambda + 2 mu) / rho) [m/s].
  double p_wave_speed() const;
};

}  // namespace sunder::mpm
