#pragma once
/// Rankine damage with linear softening: c grows with the largest principal stress ever reached.
#include "core/types.h"

namespace sunder::mpm {

/// l_max = 2 E G_f / sigma_f^2 [m]: a damage band of this width dissipates exactly the elastic energy it holds when it
/// fails. Wider bands have no softening law that keeps both strength and energy (Cervera & Chiumenti 2006).
double admissible_length(double youngs_modulus, double tensile_strength, double fracture_energy);

/// One-dimensional law r -> c. Fan (2024) eq. 2.28 with the missing cases: c = 0 below the strength, c <= 1, and
/// history by the caller (r is the running maximum of the effective stress).
struct Softening {
  double strength = 0;         ///< sigma_f used [Pa]
  double slope = 0;            ///< H = b l / (1 - b l), b = sigma_f^2 / (2 E G_f); infinite: fails at once
  double fracture_energy = 0;  ///< what a band of the given width dissipates per area [J/m^2]

  double damage(double r) const;
};

/// What to do where the band is wider than l_max.
enum class CoarseGrid {
  lower_strength,  ///< keep G_f: sigma_f' = sqrt(2 E G_f / (1.1 l))
  keep_strength,   ///< keep sigma_f: fail at once and dissipate l sigma_f^2 / (2 E) > G_f
};

/// The law for a damage band of width `band` [m]. `strength` below the argument, or `fracture_energy` above it, tells
/// that the grid is too coarse for the material (physics: l_ch >= l_max); nothing else is ever changed.
Softening make_softening(double youngs_modulus, double tensile_strength, double fracture_energy, double band,
                         CoarseGrid policy);

/// Principal stresses in ascending order with their directions as columns.
struct PrincipalStress {
  Vec3 value;
  Mat3 direction;
};

/// Symmetric eigen-decomposition; an SVD would return magnitudes and damage pure compression.
PrincipalStress principal_stress(const Mat3& cauchy_stress);

/// The largest principal stress and its direction, closed form: a few times faster than all three. The value is right
/// to 1e-8 of the norm where two are nearly equal; the direction is then one of those that belong to both.
struct LargestPrincipalStress {
  double value;
  Vec3 direction;
};
LargestPrincipalStress largest_principal_stress(const Mat3& cauchy_stress);

/// (1 - c) sigma+ + sigma-: tension is damaged, compression carries on. Fan (2024) eq. 2.30.
Mat3 damaged_stress(const PrincipalStress& effective, double damage);

}  // namespace sunder::mpm
