#pragma once
/// A body as the solver sees it: its frame turned to the principal axes of inertia, which is the only frame Bullet
/// knows.
#include <limits>
#include <memory>
#include <vector>

#include <btBulletDynamicsCommon.h>

#include "rigid/detail/hull.h"
#include "rigid/world.h"

namespace sunder::rigid::detail {

struct Body {
  BodyId id = ground_id;
  Motion motion = Motion::fixed;
  double mass = 0;
  Mat3 inertia = Mat3::Zero();        ///< body axes
  Vec3 moments = Vec3::Zero();        ///< principal moments of inertia [kg m^2]
  Quat principal = Quat::Identity();  ///< x_body = principal * x_principal
  Quat turn = Quat::Identity();       ///< x_world = turn * x_principal: what Bullet's matrix is always made from
  double restitution = 0, friction = 0;
  double hit_time = std::numeric_limits<double>::infinity();  ///< of its first hit, after the start of the step [s]
  bool newborn = false;                                       ///< member of a family that has not yet taken a step
  std::vector<Hull> parts;                                    ///< principal axes; empty for the ground
  double ground_height = 0;                                   ///< of the ground only
  double radius = 0;                                          ///< of the bounding sphere about the centre of mass [m]
  double reach = 0;             ///< how far it can come in a sub-step: contacts are looked for that far [m]
  double stride = 0;            ///< largest motion that a contact search may skip [m]
  std::vector<Box> part_boxes;  ///< of all parts, at the start of the sub-step
  Box box;                      ///< around them
  int group = -1;               ///< of its step, if it can move and the group has something to do (groups())
  bool asleep = false;          ///< at rest until something wakes it; the solver then takes it for fixed
  double last_step = 0;         ///< length of its last sub-step [s]
  double quiet_time = 0;        ///< for how long it has been slow [s]
  double slow_speed = 0;        ///< below it, and below slow_speed / radius of spin, it is slow [m/s]
  std::unique_ptr<btCollisionShape> shape;
  std::unique_ptr<btRigidBody> object;

  bool is_ground() const { return id == ground_id; }
  bool is_dynamic() const { return motion == Motion::dynamic; }
  /// Moves, or may be moved by what touches it.
  bool is_awake() const { return motion != Motion::fixed && !asleep; }
};

/// The hulls of `setup` are copied. Errors: see World::add.
std::unique_ptr<Body> make_body(BodyId id, const BodySetup& setup, const Vec3& gravity);
std::unique_ptr<Body> make_ground(const WorldSettings& settings);

/// Also zeroes the velocities of a dynamic body that falls asleep.
void set_asleep(Body& body, bool asleep);
bool is_slow(const Body& body);

BodyState state_of(const Body& body);
void place(Body& body, const BodyState& state);
/// Moves the principal axes there.
void set_place(Body& body, const Vec3& position, const Quat& turn);
Mat3 world_inertia(const Body& body);

/// Null for the ground and for bodies that are not in the list, which is in order of ids.
Body* find_body(const std::vector<Body*>& bodies, BodyId id);

/// Box around all parts at the present place.
Box bounds(const Body& body);

inline Body& body_of(const btCollisionObject& object) { return *static_cast<Body*>(object.getUserPointer()); }

}  // namespace sunder::rigid::detail
