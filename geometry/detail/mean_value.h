#pragma once
/// Values inside plane polygons.
#include <vector>

#include <Eigen/Core>

namespace sunder::geometry::detail {

/// Mean value coordinates of x in a plane polygon: weights that add up to 1, linear along edges, positive inside a
/// convex polygon. Points within 1e-12 of the polygon's size of a vertex or an edge count as on it. Source: Hormann and
/// Floater, "Mean value coordinates for arbitrary planar polygons" (2006), figure 10.
std::vector<double> mean_value_weights(const std::vector<Eigen::Vector2d>& loop, const Eigen::Vector2d& x);

}  // namespace sunder::geometry::detail
