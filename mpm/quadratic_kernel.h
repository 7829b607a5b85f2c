#pragma once
/// The quadratic B-spline on a unit grid: 27 nodes around a point.
#include <array>
#include <cmath>

#include "core/types.h"

namespace sunder::mpm {

/// Weights of the 3 x 3 x 3 nodes whose lowest corner is `base`. Node (i, j, k) has weight
/// weight[0][i] * weight[1][j] * weight[2][k] and lies at (base + (i, j, k)) - point = (i, j, k) - offset, in cells.
struct QuadraticStencil {
  std::array<int, 3> base;
  std::array<std::array<double, 3>, 3> weight;  ///< [axis][node]
  std::array<double, 3> offset;                 ///< point - base, each in [0.5, 1.5)
};

/// Second moment of the weights in cells^2: sum of w (x_i - x)(x_i - x)^T = I / 4 at every point (Jiang et al. 2015).
/// Its inverse is the factor of MLS gradients.
constexpr double quadratic_moment = 0.25;

/// Lowest node of the stencil of `point` [cells].
inline std::array<int, 3> quadratic_base(const Vec3& point) {
  const Eigen::Array3d floor = (point.array() - 0.5).floor();
  return {static_cast<int>(floor[0]), static_cast<int>(floor[1]), static_cast<int>(floor[2])};
}

/// `point` in cells. Fan (2024) eq. 2.10; the branches of Lyu (2021) eq. 3.3 belong to another argument and sum to 1.5.
inline QuadraticStencil quadratic_stencil(const Vec3& point) {
  QuadraticStencil s;
  s.base = quadratic_base(point);
  for (std::size_t a = 0; a < 3; ++a) {
    const double x = point[static_cast<Eigen::Index>(a)];
    const double f = x - s.base[a];
    s.offset[a] = f;
    s.weight[a] = {0.5 * (1.5 - f) * (1.5 - f), 0.75 - (f - 1) * (f - 1), 0.5 * (f - 0.5) * (f - 0.5)};
  }
  return s;
}

}  // namespace sunder::mpm
