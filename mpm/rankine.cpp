#include "mpm/rankine.h"

#include <cmath>

#include <Eigen/Eigenvalues>

namespace sunder::mpm {

double admissible_length(double youngs_modulus, double tensile_strength, double fracture_energy) {
  return 2 * youngs_modulus * fracture_energy / (tensile_strength * tensile_strength);
}

double Softening::damage(double r) const {
  if (r <= strength) return 0;
  if (std::isinf(slope)) return 1;
  return std::min(1.0, (1 + slope) * (1 - strength / r));
}

Softening make_softening(double youngs_modulus, double tensile_strength, double fracture_energy, double band,
                         CoarseGrid policy) {
  Softening law{tensile_strength, 0, fracture_energy};
  const double infinity = std::numeric_limits<double>::infinity();
  if (band >= admissible_length(youngs_modulus, tensile_strength, fracture_energy)) {
    if (policy == CoarseGrid::keep_strength)
      return {tensile_strength, infinity, band * tensile_strength * tensile_strength / (2 * youngs_modulus)};
    law.strength = std::sqrt(2 * youngs_modulus * fracture_energy / (1.1 * band));
  }
  const double ratio = band / admissible_length(youngs_modulus, law.strength, fracture_energy);
  law.slope = ratio / (1 - ratio);
  return law;
}

PrincipalStress principal_stress(const Mat3& cauchy_stress) {
  Eigen::SelfAdjointEigenSolver<Mat3> solver;
  solver.computeDirect(cauchy_stress);
  return {solver.eigenvalues(), solver.eigenvectors()};
}

Mat3 damaged_stress(const PrincipalStress& effective, double damage) {
  Vec3 value = effective.value;
  for (int k = 0; k < 3; ++k)
    if (value[k] > 0) value[k] *= 1 - damage;
  return effective.direction * value.asDiagonal() * effective.direction.transpose();
}

}  // namespace sunder::mpm
