#include "mpm/neo_hookean.h"

namespace sunder::mpm {

double NeoHookean::energy(const Mat3& h) const {
  const double log_j = std::log1p(volume_change(h));
  const double trace = 2 * h.trace() + h.squaredNorm();
  return 0.5 * mu_ * (trace - 2 * log_j) + 0.5 * lambda_ * log_j * log_j;
}

}  // namespace sunder::mpm
