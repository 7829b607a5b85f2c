#pragma once
/// What motion fragments start with.
#include <vector>

#include "core/types.h"

namespace sunder::pipeline {

/// Mass properties of a rigid part about its own centre of mass, axes of the common frame.
struct RigidPart {
  double mass = 0;              ///< [kg]
  Vec3 centre = Vec3::Zero();   ///< [m]
  Mat3 inertia = Mat3::Zero();  ///< [kg m^2]
};

struct Momentum {
  Vec3 linear = Vec3::Zero();   ///< [kg m/s]
  Vec3 angular = Vec3::Zero();  ///< about the origin of the frame [kg m^2/s]
};

Momentum momentum(const std::vector<RigidPart>& parts, const std::vector<Twist>& twists);
double kinetic_energy(const std::vector<RigidPart>& parts, const std::vector<Twist>& twists);

/// The parts moving together as one rigid body with this momentum.
std::vector<Twist> rigid_motion(const std::vector<RigidPart>& parts, const Momentum& total);

/// Adds one rigid motion to all parts so that their momentum becomes `total` to rounding. The masses of the parts and
/// those of the particles that drove them differ by the sampling error, which this takes out.
std::vector<Twist> with_momentum(const std::vector<RigidPart>& parts, std::vector<Twist> twists, const Momentum& total);

/// Scales what deviates from the common rigid motion so that the kinetic energy is at most `limit` [J]; momentum is
/// unchanged. A limit below the energy of the rigid motion gives the rigid motion.
std::vector<Twist> with_energy_limit(const std::vector<RigidPart>& parts, const std::vector<Twist>& twists,
                                     double limit);

}  // namespace sunder::pipeline
