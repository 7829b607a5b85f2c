#pragma once
/// Blue noise in a solid.
#include <cstdint>
#include <vector>

#include "core/progress.h"
#include "geometry/mesh.h"

namespace sunder::geometry {

/// What may stay without a point that has room for one, as a share of the volume.
constexpr double poisson_disk_left_over = 1e-6;

/// Points strictly inside the solid, no two of them closer than `radius` [m], so dense that all but 1e-6 of the solid
/// is closer than that to one of them (about 0.73 volume / radius^3 points away from the surface). Uniformly random but
/// for their distance: darts are thrown at the cells of a grid that may still take a point; cells that darts keep
/// missing are divided, and what one disk covers is dropped. Source: Ebeida, Mitchell, Patney, Davidson and Owens, "A
/// simple algorithm for maximal Poisson-disk sampling in high dimensions" (2012). Bridson's method (2007), which grows
/// from one point, would miss parts that are joined by less than a radius, and stays short of maximal. Differs in this:
/// cells are also dropped when they lie outside the solid, and the last share above is left.
///
/// Deterministic for a seed. Requires a solid. Errors: ErrorKind::usage for a radius that is not positive or so small
/// that the grid over the body, of cells radius / sqrt(3) wide, has more than 2^28 of them or 2^20 along an axis;
/// ErrorKind::mesh when the mesh has no positive volume.
std::vector<Vec3> poisson_disk(const TriangleMesh& solid, double radius, std::uint64_t seed, Progress& progress);

}  // namespace sunder::geometry
