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

// Speed with which a point that hits from a distance `gap` must leave at once, to fly as if it had hit at the surface:
// it gains 2 pull gap in v^2 on the way there and loses as much on the way back. A velocity of symplectic Euler is that
// of half a step before, hence the half steps. Without forces this is Newton's law, restitution * approach.
double rebound(double restitution, double approach, double pull, double gap, double step_before, double step) {
  const double arrival = approach + pull * step_before / 2;
  const double square = restitution * restitution * (arrival * arrival + 2 * pull * gap) - 2 * pull * gap;
  return std::max(0.0, std::sqrt(std::max(0.0, square)) - pull * step / 2);
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
    const Body& body = body_of(object);
    if (body.is_ground() || !(getForceUpdateAllAabbs() || object.isActive())) continue;
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

// Decides which points act in this step and how. A point acts if it touches or will touch before the step is over; one
// that hits acts at once and fully, so that neither restitution nor the impulse depends on the gap that the step left
// over.
void Dynamics::prepare(btPersistentManifold& manifold, double time_step) {
  const Body &a = body_of(*manifold.getBody0()), &b = body_of(*manifold.getBody1());
  const double tolerance = tolerated(manifold);
  const double touching = touching_share * std::min(a.radius, b.radius);
  const double resting = resting_steps * m_gravity.length() * time_step;
  const Vec3 acceleration = acceleration_of(a) - acceleration_of(b);
  for (int i = 0; i < manifold.getNumContacts(); ++i) {
    btManifoldPoint& point = manifold.getContactPoint(i);
    const Vec3 normal = to_eigen(point.m_normalWorldOnB);
    const double pull = -acceleration.dot(normal);
    const Vec3 where = to_eigen((point.m_positionWorldOnA + point.m_positionWorldOnB) / 2);
    const Vec3 relative = velocity_at(*a.object, where) - velocity_at(*b.object, where);
    const double approach = -relative.dot(normal), closing = approach + pull * kick_time(time_step);
    const double gap = point.getDistance() + tolerance;
    const bool acts = gap <= std::max(touching, closing * time_step);
    const bool hits = acts && approach > resting;
    prepared_.push_back({&manifold, &point, where, normal, approach, point.getDistance(), acts, hits});
    point.setDistance(!acts ? out_of_reach : hits ? std::min(gap, 0.0) : gap);
    const double leaving =
        hits ? rebound(a.restitution * b.restitution, approach, pull, std::max(gap, 0.0), last_step_, time_step) : 0;
    point.m_combinedRestitution = hits ? leaving / approach : 0;
    point.m_combinedFriction = std::sqrt(a.friction * b.friction);
    point.m_appliedImpulse *= acts ? time_step / last_step_ : 0;
  }
}

// Logs the impulses and gives the points their distances back. The impulse of a hit is no guess for the next step.
void Dynamics::harvest() {
  for (const Prepared& p : prepared_) {
    const Body &a = body_of(*p.manifold->getBody0()), &b = body_of(*p.manifold->getBody1());
    if (p.acts && p.point->m_appliedImpulse > 0)
      log_.samples.push_back({a.id, b.id, p.where, p.normal, p.point->m_appliedImpulse, p.approach,
                              patch_share * std::min(a.radius, b.radius), log_.sub_step});
    p.point->setDistance(p.distance);
    if (p.hits) p.point->m_appliedImpulse = 0;
  }
  prepared_.clear();
}

void Dynamics::solveConstraints(btContactSolverInfo& info) {
  next_tolerances_.clear();
  for (int i = 0; i < getDispatcher()->getNumManifolds(); ++i) {
    btPersistentManifold& manifold = *getDispatcher()->getManifoldByIndexInternal(i);
    if (manifold.getNumContacts() > 0) prepare(manifold, info.m_timeStep);
  }
  tolerances_.swap(next_tolerances_);
  for (int i = 0; i < m_collisionObjects.size(); ++i) body_of(*m_collisionObjects[i]).newborn = false;
  btDiscreteDynamicsWorld::solveConstraints(info);
  harvest();
  last_step_ = info.m_timeStep;
}

void Dynamics::integrateTransforms(btScalar time_step) {
  for (int i = 0; i < m_nonStaticRigidBodies.size(); ++i)
    if (m_nonStaticRigidBodies[i]->isActive()) integrate(body_of(*m_nonStaticRigidBodies[i]), time_step);
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
