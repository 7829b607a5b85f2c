#pragma once
/// Region boundaries of thousands of Voronoi cells, quickly: the duals of a Delaunay triangulation.
#include <cstdint>
#include <vector>

#include "geometry/cut.h"

namespace sunder::geometry {

/// The faces between Voronoi cells of different regions. Every Delaunay cell gives one vertex, so neighbouring faces
/// share vertices by index. Far away helper seeds close all cells near `box`. Seed i belongs to region region_of[i].
RegionBoundary delaunay_regions(const Box& box, const std::vector<Vec3>& seeds, const std::vector<int>& region_of);

/// Uniform points inside a closed mesh.
std::vector<Vec3> points_inside(const TriangleMesh& body, int count, std::uint64_t seed);

/// Per seed a region; the first seeds are the regions' own and take in neighbouring cells in turn, so all are
/// connected.
std::vector<int> grown_regions(const std::vector<Vec3>& seeds, int regions);

/// `regions` regions, each of about `cells_each` Voronoi cells of seeds in the body.
RegionBoundary cell_regions(const TriangleMesh& body, int regions, int cells_each, std::uint64_t seed);

}  // namespace sunder::geometry
