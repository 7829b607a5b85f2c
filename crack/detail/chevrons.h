#pragma once
/// Chevron lines: the ways that a crack front took over its surface.
#include <vector>

#include "core/progress.h"
#include "crack/detail/surface_field.h"

namespace sunder::crack::detail {

struct Chevron {
  std::vector<int> vertices;  ///< from the earliest on
  double length = 0;          ///< [m]
};

struct LineSettings {
  double step = 0;    ///< [m]
  double length = 0;  ///< of the longest line [m]
  double radius = 0;  ///< beside a line, vertices within it start no other [m]
};

/// Fan (2024), Algorithm 4: a line starts at the earliest vertex that no line has visited, steps along the direction to
/// the nearest unvisited vertex, and marks the vertices beside it as visited. It ends at its full length, or where no
/// unvisited vertex of its sheet is within half a step of where it steps to. A step marks what lies within the radius
/// across and half a step along: the strips of successive steps join. The start has a strip too. Lines of one vertex
/// are not lines. Ties are decided by the index of the vertex.
std::vector<Chevron> trace_lines(const FineMesh& mesh, const Sheets& sheets, const SurfaceField& field,
                                 const LineSettings& settings, Progress& progress);

/// The longest lines: a share of them, rounded up; all of equal rank by index of their first vertex.
std::vector<Chevron> longest(std::vector<Chevron> lines, double share);

/// The perturbation b of every vertex: lines as curves with values 1 at the source to 2 at the end, smeared over the
/// grid and back. The curve's length in units of the grid spacing is its weight.
std::vector<double> smear(const FineMesh& mesh, const Sheets& sheets, const std::vector<std::vector<int>>& vertices,
                          const std::vector<SheetGrid>& grids, const std::vector<Chevron>& lines, double spacing);

}  // namespace sunder::crack::detail
