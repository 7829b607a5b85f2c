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

inline Momentum operator+(const Momentum& a, const Momentum& b) { return {a.linear + b.linear, a.angular + b.angular}; }

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

/// The larger of the differences of linear and of angular momentum, over the sums of |m v| and of |r x m v| + |I w| of
/// these parts and of the expected momentum itself: how much was lost or won where much may cancel.
double relative_difference(const Momentum& expected, const Momentum& found, const std::vector<RigidPart>& parts,
                           const std::vector<Twist>& twists);

/// An impulse between a body and one of its partners at a contact; the partner gets the opposite.
struct Push {
  Vec3 impulse = Vec3::Zero();      ///< on the body [N s]
  Vec3 arm = Vec3::Zero();          ///< from the body's centre of mass to the contact [m]
  Vec3 partner_arm = Vec3::Zero();  ///< from the partner's centre of mass to the contact [m]
  int partner = -1;                 ///< index of the partner; -1: it does not yield
};

/// Largest share in [0, 1] of all pushes with which body and partners, moving rigidly, have no more kinetic energy than
/// before. Contacts that are solved side by side do not know of each other, so together they may push more than there
/// is energy for. Parts are in world axes about their own centres of mass.
double affordable_share(const RigidPart& body, const Twist& body_twist, const std::vector<RigidPart>& partners,
                        const std::vector<Twist>& partner_twists, const std::vector<Push>& pushes);

/// Mass [kg] with which a body answers a push along the unit `direction` at `arm`: 1 / (1/m + n . ((I^-1 (r x n)) x
/// r)).
double effective_mass(const RigidPart& part, const Vec3& arm, const Vec3& direction);

}  // namespace sunder::pipeline
