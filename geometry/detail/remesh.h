#pragma once
/// Remeshing through a level set.
#include "geometry/mesh.h"

namespace sunder::geometry::detail {

/// The surface of everything that the mesh encloses, seen from far away, at the given voxel size (OpenVDB: narrow-band
/// level set and dual contouring on a uniform grid). Empty when the mesh encloses nothing at that resolution. Details
/// below a voxel are lost.
TriangleMesh remeshed(const TriangleMesh& mesh, double voxel);

}  // namespace sunder::geometry::detail
