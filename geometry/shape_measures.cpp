#include "geometry/shape_measures.h"

#include <cmath>
#include <numbers>

#include <Eigen/Eigenvalues>

namespace sunder::geometry {

std::optional<ShapeMeasures> shape_measures(const MassProperties& mass) {
  if (!(mass.volume > 0) || !(mass.area > 0)) return {};
  const Mat3 second = mass.inertia.trace() / 2 * Mat3::Identity() - mass.inertia;
  const Vec3 eigenvalues =
      Eigen::SelfAdjointEigenSolver<Mat3>(second / mass.volume, Eigen::EigenvaluesOnly).eigenvalues();
  if (!(eigenvalues[0] > 0)) return {};
  const Vec3 axes = 2 * (5 * eigenvalues.reverse()).cwiseSqrt();
  return ShapeMeasures{std::cbrt(std::numbers::pi) * std::pow(6 * mass.volume, 2.0 / 3) / mass.area, axes[0] / axes[1],
                       axes[1] / axes[2], axes};
}

}  // namespace sunder::geometry
