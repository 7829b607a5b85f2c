#pragma once
/// Impactors that come flying from anywhere.
#include <cstdint>

#include "geometry/mesh.h"

namespace sunder::pipeline {

struct ImpactPoint {
  Vec3 at = Vec3::Zero();         ///< on the surface [m]
  Vec3 direction = Vec3::Zero();  ///< in which the impactor flies, of unit length
};

/// The first point of the surface on a straight flight: a direction drawn evenly from all, on a line drawn evenly from
/// those of the direction that pass through the body's bounding sphere. What is seen more is hit more, and nothing is
/// hit from behind other parts of the body. Flights that meet the surface at more than `largest_angle` from its normal
/// are drawn again. A pure function of mesh, angle and seed. Errors: ErrorKind::mesh when no flight of many is fit to
/// hit it.
ImpactPoint random_impact(const geometry::TriangleMesh& mesh, double largest_angle, std::uint64_t seed);

}  // namespace sunder::pipeline
