#pragma once
/// Heights become displacements that leave the complex valid.
#include <vector>

#include "core/progress.h"
#include "crack/detail/surface_field.h"

namespace sunder::crack::detail {

struct Relief {
  std::vector<Vec3> vertices;  ///< displaced
  std::vector<double> height;  ///< per vertex, at most what was asked [m]
  long lowered = 0;            ///< vertices that the check of folds and crossings lowered
};

/// Moves vertices along their normals by the heights, which must be 0 where a vertex must stay. No edge gets steeper
/// than 1. Where a triangle turns by more than acos(0.3) or crosses another one, its vertices are halved, in the end
/// put back; what was valid without heights is valid in the end.
Relief displaced(const FineMesh& mesh, const Sheets& sheets, const std::vector<Vec3>& normals,
                 std::vector<double> heights, Progress& progress);

}  // namespace sunder::crack::detail
