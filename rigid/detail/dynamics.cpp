#include "rigid/detail/dynamics.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "rigid/detail/contact.h"
#include "rigid/detail/convert.h"
#include "rigid/detail/narrow_phase.h"

namespace sunder::rigid::detail {
namespace {

// Gaps below this share of the smaller radius count as touching.
constexpr double touching_share = 1e-3;
// Approach below this many times what gravity adds in one step is resting: no restitution, or stacks would chatter.
constexpr double resting_steps = 2;
// Radius of a patch over the radius of the smaller body: a quarter of its size.
constexpr double patch_share = 0.5;
// Free rotation turns at most this angle per integration stage [rad].
constexpr double turn_per_stage = 0.005;
constexpr int most_stages = 64;
// Of the radius: contacts of bodies at rest are looked for this far.
constexpr double least_reach = 0.01;
// A body that was slow for so long may sleep [s].
constexpr double quiet_time = 0.5;
// Beyond any threshold of the solver: a point at this distance is passed over.
constexpr double out_of_reach = std::numeric_limits<double>::infinity();

Vec3 velocity_at(const btRigidBody& object, const Vec3& point) {
  return to_eigen(object.getVelocityInLocalPoint(to_bullet(point) - object.getCenterOfMassPosition()));
}

Quat turn_by(const Vec3& rotation) {
  const double angle = rotation.norm();
  return angle > 0 ? Quat(Eigen::AngleAxisd(angle, rotation / angle)) : Quat::Identity();
}

Vec3 spin(const Quat& orientation, const Vec3& moments, const Vec3& angular_momentum) {
  const Vec3 local = orientation.conjugate() * angular_momentum;
  return orientation * Vec3(local.cwiseQuotient(moments));
}

// Torque-free rotation by the explicit midpoint rule on the orientation with the angular momentum held: |L| is exact
// and the energy stays between L^2 / 2 I_max and L^2 / 2 I_min at any step, which none of Bullet's gyroscopic options
// offers.
void rotate_freely(Quat& orientation, Vec3& angular, const Vec3& moments, double time_step) {
  const Vec3 local = orientation.conjugate() * angular;
  const Vec3 momentum = orientation * Vec3(local.cwiseProduct(moments));
  const double angle = angular.norm() * time_step;
  const int stages = std::clamp(static_cast<int>(std::ceil(angle / turn_per_stage)), 1, most_stages);
  const double h = time_step / stages;
  for (int i = 0; i < stages; ++i) {
    const Quat middle = turn_by(angular * (h / 2)) * orientation;
    orientation = (turn_by(spin(middle, moments, momentum) * h) * orientation).normalized();
    angular = spin(orientation, moments, momentum);
  }
}

void integrate(Body& body, double time_step) {
  btRigidBody& object = *body.object;
  btTransform place = object.getWorldTransform();
  place.setOrigin(place.getOrigin() + object.getLinearVelocity() * time_step);
  Vec3 angular = to_eigen(object.getAngularVelocity());
  if (!angular.isZero(0)) {
    Quat orientation = to_eigen(place.getRotation());
    if (body.is_dynamic())
      rotate_freely(orientation, angular, body.moments, time_step);
    else
      orientation = (turn_by(angular * time_step) * orientation).normalized();
    place.setRotation(to_bullet(orientation));
    object.setAngularVelocity(to_bullet(angular));
  }
  object.setCenterOfMassTransform(place);
}

PartPair pair_of(const btPersistentManifold& manifold) {
  const btManifoldPoint& point = manifold.getContactPoint(0);
  return {body_of(*manifold.getBody0()).id, body_of(*manifold.getBody1()).id, point.m_index0, point.m_index1};
}

double deepest(const btPersistentManifold& manifold) {
  double depth = 0;
  for (int i = 0; i < manifold.getNumContacts(); ++i)
    depth = std::max(depth, -manifold.getContactPoint(i).getDistance());
  return depth;
}

// Contacts are looked for as far as a body can come in a sub-step, and a little further: in a heap at rest that leaves
// the true neighbours only.
double reach_of(const Body& body, double gravity, double time_step) {
  const btRigidBody& object = *body.object;
  const double speed = object.getLinearVelocity().length() + object.getAngularVelocity().length() * body.radius;
  return least_reach * body.radius + (speed + gravity * time_step) * time_step;
}

Vec3 arm_of(const Body& body, const Vec3& point) {
  return body.is_ground() ? Vec3(Vec3::Zero()) : Vec3(point - to_eigen(body.object->getCenterOfMassPosition()));
}

// A hit in free flight, seen from the partner: `gap` away, closing at `approach`, pulled together by `pull` [m/s^2].
struct Fall {
  double approach, pull, gap, step_before, step;
};

// Speed with which the point leaves after Newton's law, v' = e v, at the moment it arrives. A velocity of symplectic
// Euler is that of half a step before, on the way in and on the way out; without forces this is restitution * approach.
// What falls back within a step stays.
double leaving_speed(const Fall& fall, double restitution, double hit_time) {
  const double now = fall.approach + fall.pull * fall.step_before / 2;
  const double leaving = restitution * std::sqrt(std::max(0.0, now * now + 2 * fall.pull * fall.gap));
  if (leaving <= fall.pull * fall.step) return 0;
  return std::max(0.0, leaving + fall.pull * (hit_time - fall.step / 2));
}

}  // namespace

Dynamics::Dynamics(btDispatcher* dispatcher, btBroadphaseInterface* broadphase, btConstraintSolver* solver,
                   btCollisionConfiguration* configuration, Tolerances& tolerances, ContactLog& log,
                   double length_of_last_step)
    : btDiscreteDynamicsWorld(dispatcher, broadphase, solver, configuration),
      tolerances_(tolerances),
      log_(log),
      last_step_(length_of_last_step) {}

// Bullet's own version widens every box by 2 cm, which makes neighbours of all the small fragments in a heap.
void Dynamics::updateAabbs() {
  for (int i = 0; i < m_collisionObjects.size(); ++i) {
    btCollisionObject& object = *m_collisionObjects[i];
    Body& body = body_of(object);
    if (body.is_ground() || !(getForceUpdateAllAabbs() || object.isActive())) continue;
    body.reach = reach_of(body, m_gravity.length(), getDispatchInfo().m_timeStep);
    btVector3 low, high;
    object.getCollisionShape()->getAabb(object.getWorldTransform(), low, high);
    const btVector3 reach(body.reach, body.reach, body.reach);
    getBroadphase()->setAabb(object.getBroadphaseHandle(), low - reach, high + reach, getDispatcher());
  }
}

// Velocities belong to the middle of the last step, so with steps of changing length the next kick spans half of both;
// otherwise a fall through sub-steps would not conserve energy.
double Dynamics::kick_time(double time_step) const { return (last_step_ + time_step) / 2; }

Vec3 Dynamics::acceleration_of(const Body& body) const {
  return body.is_dynamic() && body.object->isActive() ? to_eigen(m_gravity) : Vec3::Zero();
}

void Dynamics::kick(double time_step) {
  const btVector3 gravity = m_gravity * (kick_time(time_step) / time_step);
  for (int i = 0; i < m_nonStaticRigidBodies.size(); ++i)
    if (m_nonStaticRigidBodies[i]->isActive()) m_nonStaticRigidBodies[i]->setGravity(gravity);
}

// A pair with a newborn starts with its whole overlap tolerated; from then on what is tolerated only shrinks.
double Dynamics::tolerated(const btPersistentManifold& manifold) {
  const PartPair pair = pair_of(manifold);
  const double overlap = deepest(manifold);
  const bool at_birth = body_of(*manifold.getBody0()).newborn || body_of(*manifold.getBody1()).newborn;
  const auto before = tolerances_.find(pair);
  const double allowed = at_birth ? overlap : before == tolerances_.end() ? 0 : std::min(before->second, overlap);
  if (allowed > 0) next_tolerances_[pair] = allowed;
  return allowed;
}

// Finds the points that touch or will touch before the step is over. One that hits does so at its own time within the
// step, so that neither restitution nor impulse nor place depend on how the steps fall.
void Dynamics::prepare(btPersistentManifold& manifold, double time_step) {
  const Body &a = body_of(*manifold.getBody0()), &b = body_of(*manifold.getBody1());
  const double tolerance = tolerated(manifold);
  const double touching = touching_share * std::min(a.radius, b.radius);
  const double resting = resting_steps * m_gravity.length() * time_step;
  const Vec3 acceleration = acceleration_of(a) - acceleration_of(b);
  for (int i = 0; i < manifold.getNumContacts(); ++i) {
    btManifoldPoint& point = manifold.getContactPoint(i);
    const Vec3 normal = to_eigen(point.m_normalWorldOnB);
    const Vec3 relative = velocity_at(*a.object, to_eigen(point.m_positionWorldOnA)) -
                          velocity_at(*b.object, to_eigen(point.m_positionWorldOnB));
    Prepared p{&manifold, &point, normal, -relative.dot(normal), point.getDistance()};
    p.gap = p.distance + tolerance;
    p.pull = -acceleration.dot(normal);
    p.closing = p.approach + p.pull * kick_time(time_step);
    p.acts = p.gap <= std::max(touching, p.closing * time_step);
    p.hits = p.acts && p.approach > resting;
    p.hit_time = p.hits ? std::clamp(p.gap / p.closing, 0.0, time_step) : 0;
    prepared_.push_back(p);
  }
}

// Of the points of two bodies that hit, those that do so first: the others are for the next step, if they still hit
// then.
void Dynamics::keep_first_hits() {
  std::map<std::pair<BodyId, BodyId>, double> first;
  const auto pair = [](const Prepared& p) {
    return std::pair(body_of(*p.manifold->getBody0()).id, body_of(*p.manifold->getBody1()).id);
  };
  for (const Prepared& p : prepared_) {
    if (!p.hits) continue;
    double& earliest = first.emplace(pair(p), p.hit_time).first->second;
    earliest = std::min(earliest, p.hit_time);
  }
  for (Prepared& p : prepared_) {
    if (!p.hits) continue;
    Body &a = body_of(*p.manifold->getBody0()), &b = body_of(*p.manifold->getBody1());
    const double then = first.at(pair(p));
    p.acts = p.hits = p.gap - p.closing * then <= touching_share * std::min(a.radius, b.radius);
    a.hit_time = std::min(a.hit_time, then);
    b.hit_time = std::min(b.hit_time, then);
  }
}

// Tells the solver how each point acts.
void Dynamics::apply(const Prepared& p, double time_step) {
  const Body &a = body_of(*p.manifold->getBody0()), &b = body_of(*p.manifold->getBody1());
  p.point->setDistance(!p.acts ? out_of_reach : p.hits ? std::min(p.gap, 0.0) : p.gap);
  p.point->m_combinedFriction = std::sqrt(a.friction * b.friction);
  p.point->m_combinedRestitution = 0;
  p.point->m_appliedImpulse *= p.acts ? time_step / last_step_ : 0;
  if (!p.hits) return;
  const Fall fall{p.approach, p.pull, std::max(p.gap, 0.0), last_step_, time_step};
  p.point->m_combinedRestitution = leaving_speed(fall, a.restitution * b.restitution, p.hit_time) / p.approach;
}

// Moves bodies that hit to where they do; integrateTransforms takes them through the rest of the step.
void Dynamics::move_to_hits() {
  for (int i = 0; i < m_nonStaticRigidBodies.size(); ++i) {
    Body& body = body_of(*m_nonStaticRigidBodies[i]);
    if (std::isfinite(body.hit_time) && body.object->isActive()) integrate(body, body.hit_time);
  }
  for (const Prepared& p : prepared_) {
    p.point->m_positionWorldOnA = p.manifold->getBody0()->getWorldTransform() * p.point->m_localPointA;
    p.point->m_positionWorldOnB = p.manifold->getBody1()->getWorldTransform() * p.point->m_localPointB;
  }
}

// Logs the impulses and gives the points their distances back. The impulse of a hit is no guess for the next step.
void Dynamics::harvest() {
  for (const Prepared& p : prepared_) {
    const Body &a = body_of(*p.manifold->getBody0()), &b = body_of(*p.manifold->getBody1());
    const Vec3 where = to_eigen((p.point->m_positionWorldOnA + p.point->m_positionWorldOnB) / 2);
    if (p.acts && p.point->m_appliedImpulse > 0)
      log_.samples.push_back({a.id, b.id, where, p.normal, arm_of(a, where), arm_of(b, where),
                              p.point->m_appliedImpulse, p.approach, patch_share * std::min(a.radius, b.radius),
                              log_.sub_step});
    p.point->setDistance(p.distance);
    if (p.hits) p.point->m_appliedImpulse = 0;
  }
  prepared_.clear();
}

void Dynamics::solveConstraints(btContactSolverInfo& info) {
  next_tolerances_.clear();
  for (int i = 0; i < m_collisionObjects.size(); ++i)
    body_of(*m_collisionObjects[i]).hit_time = std::numeric_limits<double>::infinity();
  for (int i = 0; i < getDispatcher()->getNumManifolds(); ++i) {
    btPersistentManifold& manifold = *getDispatcher()->getManifoldByIndexInternal(i);
    if (manifold.getNumContacts() > 0) prepare(manifold, info.m_timeStep);
  }
  tolerances_.swap(next_tolerances_);
  for (int i = 0; i < m_collisionObjects.size(); ++i) body_of(*m_collisionObjects[i]).newborn = false;
  keep_first_hits();
  for (const Prepared& p : prepared_) apply(p, info.m_timeStep);
  move_to_hits();
  btDiscreteDynamicsWorld::solveConstraints(info);
  harvest();
  last_step_ = info.m_timeStep;
}

void Dynamics::integrateTransforms(btScalar time_step) {
  for (int i = 0; i < m_nonStaticRigidBodies.size(); ++i) {
    Body& body = body_of(*m_nonStaticRigidBodies[i]);
    const double done = std::isfinite(body.hit_time) ? body.hit_time : 0;
    if (body.object->isActive()) integrate(body, time_step - done);
  }
}

// Bullet waits two seconds before it lets bodies sleep; a heap of fragments is at rest sooner.
void Dynamics::updateActivationState(btScalar time_step) {
  for (int i = 0; i < m_nonStaticRigidBodies.size(); ++i) {
    btRigidBody& object = *m_nonStaticRigidBodies[i];
    if (object.getDeactivationTime() > quiet_time) object.setDeactivationTime(std::numeric_limits<float>::max());
  }
  btDiscreteDynamicsWorld::updateActivationState(time_step);
}

struct Simulation::Parts {
  NarrowPhase configuration;
  btCollisionDispatcher dispatcher;
  btDbvtBroadphase broadphase;
  btSequentialImpulseConstraintSolver solver;
  Dynamics world;

  Parts(Tolerances& tolerances, ContactLog& log, double last_step)
      : dispatcher(&configuration),
        world(&dispatcher, &broadphase, &solver, &configuration, tolerances, log, last_step) {}
};

Simulation::Simulation(const WorldSettings& settings, double last_step, Tolerances& tolerances, ContactLog& log)
    : parts_(std::make_unique<Parts>(tolerances, log, last_step)) {
  Dynamics& world = parts_->world;
  world.setGravity(to_bullet(settings.gravity));
  world.setForceUpdateAllAabbs(false);
  world.getDispatchInfo().m_deterministicOverlappingPairs = true;
  btContactSolverInfo& info = world.getSolverInfo();
  info.m_numIterations = 30;
  info.m_solverMode = SOLVER_USE_WARMSTARTING | SOLVER_USE_2_FRICTION_DIRECTIONS;
  // Bullet's 0.85 throws a part of the converged impulses away in each step, and small towers creep sideways: five
  // boxes of 1 cm by 8 % of a box in 10 s, against 0.02 % with 1.
  info.m_warmstartingFactor = 1;
  // Overlap is corrected in positions only, whatever its depth: it must not turn into velocity.
  info.m_splitImpulse = true;
  info.m_splitImpulsePenetrationThreshold = out_of_reach;
  info.m_restitutionVelocityThreshold = 0;
}

Simulation::~Simulation() {
  auto& objects = parts_->world.getCollisionObjectArray();
  while (objects.size() > 0) parts_->world.removeCollisionObject(objects[objects.size() - 1]);
}

void Simulation::insert(Body& body) {
  const int state = body.object->getActivationState();
  parts_->world.addRigidBody(body.object.get());
  if (body.motion != Motion::fixed) body.object->forceActivationState(state);
}

void Simulation::wake_neighbours(Body& body) {
  const btBroadphaseProxy* proxy = body.object->getBroadphaseHandle();
  const auto& pairs = parts_->broadphase.getOverlappingPairCache()->getOverlappingPairArray();
  for (int i = 0; i < pairs.size(); ++i) {
    if (pairs[i].m_pProxy0 != proxy && pairs[i].m_pProxy1 != proxy) continue;
    const btBroadphaseProxy* other = pairs[i].m_pProxy0 == proxy ? pairs[i].m_pProxy1 : pairs[i].m_pProxy0;
    static_cast<btCollisionObject*>(other->m_clientObject)->activate();
  }
}

void Simulation::erase(Body& body) {
  wake_neighbours(body);
  parts_->world.removeRigidBody(body.object.get());
}

void Simulation::advance(double time_step) {
  parts_->world.kick(time_step);
  parts_->world.stepSimulation(time_step, 0);
}

double Simulation::last_step() const { return parts_->world.last_step(); }

}  // namespace sunder::rigid::detail
