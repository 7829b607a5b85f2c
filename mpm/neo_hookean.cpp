#include "mpm/neo_hookean.h"

#include <cmath>

namespace sunder::mpm {

double volume_change(const Mat3& h) {
  const double minors = h(0, 0) * h(1, 1) - h(0, 1) * h(1, 0) + h(0, 0) * h(2, 2) - h(0, 2) * h(2, 0) +
                        h(1, 1) * h(2, 2) - h(1, 2) * h(2, 1);
  return h.trace() + minors + h.determinant();
}

Mat3 NeoHookean::cauchy_stress(const Mat3& h, double volume_change_) const {
  const Mat3 left_cauchy_green_minus_identity = h + h.transpose() + h * h.transpose();
  Mat3 kirchhoff = mu_ * left_cauchy_green_minus_identity;
  kirchhoff.diagonal().array() += lambda_ * std::log1p(volume_change_);
  return kirchhoff / (1 + volume_change_);
}

double NeoHookean::energy(const Mat3& h) const {
  const double log_j = std::log1p(volume_change(h));
  const double trace = 2 * h.trace() + h.squaredNorm();
  return 0.5 * mu_ * (trace - 2 * log_j) + 0.5 * lambda_ * log_j * log_j;
}

}  // namespace sunder::mpm
