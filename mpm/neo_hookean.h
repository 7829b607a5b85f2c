#pragma once
/// Compressible neo-Hookean solid in terms of H = F - I, so that strains of 1e-6 keep all their digits.
/// mpm/detail/lane_laws.h is the same for several particles at once.
#include <cmath>

#include "core/types.h"
#include "mpm/material.h"

namespace sunder::mpm {

/// J - 1 of F = I + H without cancellation: tr H + I2(H) + det H.
inline double volume_change(const Mat3& h) {
  const double minors = h(0, 0) * h(1, 1) - h(0, 1) * h(1, 0) + h(0, 0) * h(2, 2) - h(0, 2) * h(2, 0) +
                        h(1, 1) * h(2, 2) - h(1, 2) * h(2, 1);
  return h.trace() + minors + h.determinant();
}

class NeoHookean {
 public:
  explicit NeoHookean(const Material& material) : mu_(material.shear_modulus()), lambda_(material.lame_lambda()) {}

  /// Cauchy stress (mu (b - I) + lambda ln J I) / J [Pa], symmetric; b - I = H + H^T + H H^T. Fan (2024) eq. 2.7-2.8 in
  /// H. Requires J > 0; `volume_change_` is volume_change(H).
  Mat3 cauchy_stress(const Mat3& h, double volume_change_) const {
    const double inverse = 1 / (1 + volume_change_), mu = mu_ * inverse;
    Mat3 stress = mu * (h + h.transpose() + h.lazyProduct(h.transpose()));
    stress.diagonal().array() += inverse * lambda_ * std::log1p(volume_change_);
    return stress;
  }

  /// Stored energy per reference volume, mu/2 (tr(b - I) - 2 ln J) + lambda/2 (ln J)^2 [J/m^3].
  double energy(const Mat3& displacement_gradient) const;

 private:
  double mu_, lambda_;
};

}  // namespace sunder::mpm
