#pragma once
/// Filling a solid with points.
#include <cstdint>
#include <vector>

#include "core/progress.h"
#include "geometry/mesh.h"

namespace sunder::geometry {

struct SampleSettings {
  int count = 20000;     ///< points wanted; the result is within a few percent of it
  double jitter = 0.25;  ///< largest displacement along each axis of the lattice, in spacings
  std::uint64_t seed = 1;
};

struct Samples {
  std::vector<Vec3> points;  ///< strictly inside the solid [m]
  double spacing = 0;        ///< lattice spacing = cbrt(volume / count) [m]
};

/// A cubic lattice, rotated by a fixed generic rotation against the axes (so that cracks do not follow them), jittered
/// by (seed, lattice index) and kept where it is inside. Thin walls: for a body whose thinnest extent is under six
/// spacings the lattice is layered evenly across it instead, and across a second extent if that is thin too, so that
/// every column has the same number of layers. Requires a solid (inspect(mesh).is_solid()). Inside is decided by the
/// parity of crossings along a ray through each point with exact predicates. Errors: ErrorKind::usage for a count below
/// one, ErrorKind::mesh when the mesh has no positive volume.
Samples sample_solid(const TriangleMesh& solid, const SampleSettings& settings, Progress& progress);

}  // namespace sunder::geometry
