#pragma once
/// Volume integrals of closed meshes, exact for polyhedra (divergence theorem).
#include "geometry/mesh.h"

namespace sunder::geometry {

struct MassProperties {
  double volume = 0;             ///< [m^3]; negative when the mesh is inside out
  double area = 0;               ///< [m^2]
  Vec3 centroid = Vec3::Zero();  ///< [m]
  Mat3 inertia = Mat3::Zero();   ///< about the centroid, for density 1 [m^5]
};

/// Mirtich, "Fast and accurate computation of polyhedral mass properties" (1996), in tetrahedron form. Integrals are
/// taken about the box centre so that a mesh far from the origin loses no digits. An empty or zero-volume mesh gives
/// centroid = box centre.
MassProperties mass_properties(const TriangleMesh& mesh);

}  // namespace sunder::geometry
