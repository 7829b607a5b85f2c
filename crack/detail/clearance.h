#pragma once
/// How far vertices may move before they could meet another sheet.
#include <vector>

#include "crack/detail/surface_field.h"

namespace sunder::crack::detail {

/// Per vertex, at most `most` [m]: 0 where it must stay; rising from there with a slope of 1/2; at most 0.4 of the
/// distance to another sheet, or to a part of its own that faces it (so two sheets never meet halfway). Distances are
/// to boxes around patches of about most / 3, never too large.
std::vector<double> clearance(const FineMesh& mesh, const Sheets& sheets, const std::vector<Vec3>& normals, double most,
                              double edge_length);

/// Lowers values until no edge is steeper than `slope`: the largest such function below the given one.
void limit_slope(const FineMesh& mesh, const EdgeGraph& edges, double slope, std::vector<double>& values);

}  // namespace sunder::crack::detail
