#include "mpm/rankine.h"

#include <algorithm>
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

LargestPrincipalStress largest_principal_stress(const Mat3& s) {
  const double mean = s.trace() / 3;
  Mat3 b = s - mean * Mat3::Identity();
  const double p = std::sqrt(b.squaredNorm() / 6);
  if (!(p > 1e-12 * std::abs(mean)) || !std::isfinite(p)) return {mean, Vec3::UnitX()};
  b /= p;
  // beta^3 - 3 beta = det b; beta = 2 cos(angle) in [1, 2].
  const double beta = 2 * std::cos(std::acos(std::clamp(0.5 * b.determinant(), -1.0, 1.0)) / 3);
  // (b - beta_2)(b - beta_3), the projector on the direction but for a factor.
  const Mat3 projector = b.lazyProduct(b) + beta * b + (beta * beta - 3) * Mat3::Identity();
  Eigen::Index column;
  const double norm = projector.colwise().squaredNorm().maxCoeff(&column);
  if (norm < 1e-12) {  // the two largest are equal: all directions across the third
    const PrincipalStress all = principal_stress(s);
    return {all.value[2], all.direction.col(2)};
  }
  return {mean + p * beta, projector.col(column) / std::sqrt(norm)};
}

Mat3 damaged_stress(const PrincipalStress& effective, double damage) {
  Vec3 value = effective.value;
  for (int k = 0; k < 3; ++k)
    if (value[k] > 0) value[k] *= 1 - damage;
  return effective.direction * value.asDiagonal() * effective.direction.transpose();
}

}  // namespace sunder::mpm
