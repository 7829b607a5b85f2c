#pragma once
/// B-splines on a unit grid: the weights between a point and the nodes around it. Functions are static because code
/// that is compiled once per instruction set reads this header: an inline function shared between those would be linked
/// from any of them.

namespace sunder::mpm {

enum class Spline { quadratic, cubic };

/// Nodes per axis that a point touches.
static constexpr int stencil_width(Spline spline) { return spline == Spline::quadratic ? 3 : 4; }

/// The lowest of them is floor(x - shift).
static constexpr double stencil_shift(Spline spline) { return spline == Spline::quadratic ? 0.5 : 1; }

/// Second moment of the weights in cells^2: sum of w (x_i - x)(x_i - x)^T at every point (Jiang et al. 2015).
static constexpr double spline_moment(Spline spline) { return spline == Spline::quadratic ? 1.0 / 4 : 1.0 / 3; }

/// Weights of the nodes along one axis, `offset` from node 1 in cells: in [-0.5, 0.5) for quadratic splines (the fourth
/// weight is zero), in [0, 1) for cubic ones. Fan (2024) eq. 2.10; the branches of Lyu (2021) eq. 3.3 belong to another
/// argument and sum to 1.5.
static constexpr void spline_weights(Spline spline, double offset, double weight[4]) {
  const double o = offset, r = 1 - offset;
  if (spline == Spline::quadratic) {
    weight[0] = 0.5 * (0.5 - o) * (0.5 - o);
    weight[1] = 0.75 - o * o;
    weight[2] = 0.5 * (0.5 + o) * (0.5 + o);
    weight[3] = 0;
  } else {
    weight[0] = r * r * r * (1.0 / 6);
    weight[1] = 2.0 / 3 - o * o * (1 - 0.5 * o);
    weight[2] = 2.0 / 3 - r * r * (1 - 0.5 * r);
    weight[3] = o * o * o * (1.0 / 6);
  }
}

}  // namespace sunder::mpm
