#pragma once
/// The 27 nodes of a grid around a point, with the weights of the quadratic B-spline.
#include "crack/detail/index_table.h"

namespace sunder::crack::detail {

/// Nodes lie at integer multiples of the spacing.
struct SplineStencil {
  GridCell base;  ///< the lowest of the 3 x 3 x 3 nodes
  Mat3 weight;    ///< weight(axis, offset): their products are the nodes' weights and add up to 1

  SplineStencil(const Vec3& x, double spacing) {
    const Vec3 scaled = x / spacing;
    base = (scaled.array() - 0.5).floor().cast<int>();
    const Vec3 f = scaled - base.cast<double>();
    weight.col(0) = 0.5 * (1.5 - f.array()).square();
    weight.col(1) = 0.75 - (f.array() - 1).square();
    weight.col(2) = 0.5 * (f.array() - 0.5).square();
  }

  /// Calls visit(key of the node, its weight), in a fixed order.
  template <typename Visit>
  void for_each(Visit&& visit) const {
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) {
        const double w = weight(0, i) * weight(1, j);
        for (int k = 0; k < 3; ++k) visit(cell_key(base + GridCell(i, j, k)), w * weight(2, k));
      }
  }
};

}  // namespace sunder::crack::detail
