#pragma once
/// What chevron lines follow: normals, times and directions at the vertices of sheets.
#include <vector>

#include "crack/detail/sheet_grid.h"
#include "crack/detail/sheets.h"
#include "crack/time_field.h"

namespace sunder::crack::detail {

struct SurfaceField {
  std::vector<Vec3> normal;     ///< unit, from the lower region to the higher; zero where a vertex must stay
  std::vector<double> time;     ///< [s], -1: unknown
  std::vector<Vec3> direction;  ///< unit, in the tangent plane: where the crack ran to; zero: unknown
};

/// The vertices of every sheet that may move.
std::vector<std::vector<int>> vertices_by_sheet(const Sheets& sheets);

/// Area-weighted normals, smoothed over the grid: vertices that are close have normals that are close, however small
/// and steep the faces between them are.
std::vector<Vec3> sheet_normals(const FineMesh& mesh, const Sheets& sheets,
                                const std::vector<std::vector<int>>& vertices, const std::vector<SheetGrid>& grids);

/// Times and directions of the vertices in `box`. One that the field does not reach, or where the gradient points out
/// of the surface, takes the linear field of the nearest vertex along edges that has them, never below 0.
void add_times(const FineMesh& mesh, const Sheets& sheets, const TimeField& times, const Box& box, SurfaceField& field);

}  // namespace sunder::crack::detail
