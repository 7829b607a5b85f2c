#include "rigid/detail/dynamics.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "core/stopwatch.h"
#include "rigid/detail/contact.h"
#include "rigid/detail/convert.h"
#include "rigid/detail/encounters.h"

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
// Of the energy of a rotation: more in one step is a rotation that was not followed.
constexpr double most_energy_error = 0.01;
// Of the kinetic energy: what the solver may make of a fully elastic hit (0.6 % in a cradle of five balls); the bound
// falls with the square of the restitution, as what is left of a hit does.
constexpr double most_gain = 0.01;
// Of the radius: contacts of bodies at rest are looked for this far.
constexpr double least_reach = 0.01;
// A point closer than this share of the smaller radius to one of the last step takes over its impulse as a first guess.
constexpr double same_point_share = 0.05;
// Beyond BT_LARGE_FLOAT, the solver's threshold: a point at this distance is passed over.
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
// offers. Those bounds are far apart for a needle, and what spins too fast to be followed would wander between them: it
// turns about its axis instead, which keeps energy and |L|.
void rotate_freely(Quat& orientation, Vec3& angular, const Vec3& moments, double time_step) {
  const Vec3 local = orientation.conjugate() * angular;
  const Vec3 momentum = orientation * Vec3(local.cwiseProduct(moments));
  const double angle = angular.norm() * time_step, energy = angular.dot(momentum);
  const int stages = std::clamp(static_cast<int>(std::ceil(angle / turn_per_stage)), 1, most_stages);
  const double h = time_step / stages;
  Quat turned = orientation;
  Vec3 spinning = angular;
  for (int i = 0; i < stages; ++i) {
    const Quat middle = turn_by(spinning * (h / 2)) * turned;
    turned = (turn_by(spin(middle, moments, momentum) * h) * turned).normalized();
    spinning = spin(turned, moments, momentum);
  }
  const bool lost = std::abs(spinning.dot(momentum) - energy) > most_energy_error * energy;
  orientation = lost ? (turn_by(angular * time_step) * orientation).normalized() : turned;
  if (!lost) angular = spinning;
}

void integrate(Body& body, double time_step) {
  btRigidBody& object = *body.object;
  const Vec3 position =
      to_eigen(object.getWorldTransform().getOrigin()) + to_eigen(object.getLinearVelocity()) * time_step;
  Quat turn = body.turn;
  Vec3 angular = to_eigen(object.getAngularVelocity());
  if (!angular.isZero(0)) {
    if (body.is_dynamic())
      rotate_freely(turn, angular, body.moments, time_step);
    else
      turn = (turn_by(angular * time_step) * turn).normalized();
    object.setAngularVelocity(to_bullet(angular));
  }
  set_place(body, position, turn);
}

// The solver pushes overlaps apart by moving bodies, and knows their matrices alone.
void take_over_turn(Body& body) {
  const btTransform& place = body.object->getWorldTransform();
  if (!(place.getBasis() == btMatrix3x3(to_bullet(body.turn)))) body.turn = to_eigen(place.getRotation()).normalized();
}

double deepest(const Manifold& manifold) {
  double depth = 0;
  for (const Contact& contact : manifold.contacts) depth = std::max(depth, -contact.distance);
  return depth;
}

btManifoldPoint to_point(const Contact& contact, const btTransform& place_a, const btTransform& place_b) {
  const btVector3 on_a = to_bullet(contact.on_a), on_b = to_bullet(contact.on_b);
  btManifoldPoint point(place_a.invXform(on_a), place_b.invXform(on_b), to_bullet(contact.normal), contact.distance);
  point.m_positionWorldOnA = on_a;
  point.m_positionWorldOnB = on_b;
  return point;
}

// The first guess for a point's impulse: that of the nearest old point, which is then used up.
double inherited(const Vec3& on_a, std::vector<ContactMemory::Point>& old, double same_point) {
  auto nearest = old.end();
  double distance = same_point;
  for (auto it = old.begin(); it != old.end(); ++it) {
    const double d = (it->on_a - on_a).norm();
    if (d < distance) distance = d, nearest = it;
  }
  if (nearest == old.end()) return 0;
  const double impulse = nearest->impulse;
  old.erase(nearest);
  return impulse;
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

// Kinetic, after a push of `gain` [m/s].
double energy_of(const Body& body, const Vec3& gain) {
  if (!body.is_dynamic()) return 0;
  const Vec3 velocity = to_eigen(body.object->getLinearVelocity()) + gain;
  const Vec3 spin = to_eigen(body.object->getAngularVelocity());
  return 0.5 * body.mass * velocity.squaredNorm() + 0.5 * spin.dot(world_inertia(body) * spin);
}

// What a solve changes of a body.
struct Start {
  btVector3 linear, angular;
  btTransform place;
};

std::vector<Start> starts_of(const std::vector<Body*>& bodies) {
  std::vector<Start> starts;
  for (const Body* body : bodies)
    starts.push_back(
        {body->object->getLinearVelocity(), body->object->getAngularVelocity(), body->object->getWorldTransform()});
  return starts;
}

void restore(const Start& start, btRigidBody& object) {
  object.setLinearVelocity(start.linear);
  object.setAngularVelocity(start.angular);
  object.setWorldTransform(start.place);
}

// A hit in free flight, seen from the partner: `gap` away, closing at `now`, pulled together by `pull` [m/s^2].
struct Fall {
  double now, pull, gap, step;
};

// Speed with which the point leaves after Newton's law, v' = e v, at the moment it arrives. A velocity of symplectic
// Euler is that of half a step before, on the way in and on the way out; without forces this is restitution * approach.
// What falls back within a step stays.
double leaving_speed(const Fall& fall, double restitution, double hit_time) {
  const double leaving = restitution * std::sqrt(std::max(0.0, fall.now * fall.now + 2 * fall.pull * fall.gap));
  if (leaving <= fall.pull * fall.step) return 0;
  return std::max(0.0, leaving + fall.pull * (hit_time - fall.step / 2));
}

}  // namespace

Dynamics::Dynamics(const Vec3& gravity) : gravity_(gravity) {
  info_.m_numIterations = 30;
  info_.m_solverMode = SOLVER_USE_WARMSTARTING | SOLVER_USE_2_FRICTION_DIRECTIONS;
  // Bullet's 0.85 throws a part of the converged impulses away in each step, and small towers creep sideways: five
  // boxes of 1 cm by 8 % of a box in 10 s, against 0.02 % with 1.
  info_.m_warmstartingFactor = 1;
  // Overlap is corrected in positions only, whatever its depth: it must not turn into velocity.
  info_.m_splitImpulse = true;
  info_.m_splitImpulsePenetrationThreshold = out_of_reach;
  info_.m_restitutionVelocityThreshold = 0;
}

Vec3 Dynamics::acceleration_of(const Body& body) const {
  return body.is_dynamic() && !body.asleep ? gravity_ : Vec3(Vec3::Zero());
}

// Velocities belong to the middle of a body's last step, so with steps of changing length the next kick spans half of
// both; otherwise a fall through sub-steps would not conserve energy. What gravity adds from there to `time` after now.
Vec3 Dynamics::gain(const Body& body, double time) const { return acceleration_of(body) * (body.last_step / 2 + time); }

// Manifolds of all pairs of which one body at least is awake and one dynamic. What is hit hard wakes with all that it
// touches, and then takes part in the same sub-step.
void Dynamics::find_contacts(const Step& step) {
  found_.clear();
  std::vector<BodyPair> waiting = near_pairs(step.bodies, step.ground);
  const auto body = [&](int i) { return i == ground_index ? step.ground : step.bodies[static_cast<std::size_t>(i)]; };
  std::erase_if(waiting,
                [&](const BodyPair& p) { return !body(p.first)->is_dynamic() && !body(p.second)->is_dynamic(); });
  for (;;) {
    const auto active = std::stable_partition(waiting.begin(), waiting.end(), [&](const BodyPair& p) {
      return !body(p.first)->is_awake() && !body(p.second)->is_awake();
    });
    std::vector<Manifold> more = manifolds_of({active, waiting.end()}, step.bodies, step.ground);
    waiting.erase(active, waiting.end());
    std::move(more.begin(), more.end(), std::back_inserter(found_));
    if (!wake(calls(step), step.memory, step.bodies)) break;
  }
  std::sort(found_.begin(), found_.end(), [](const Manifold& m, const Manifold& n) { return m.pair < n.pair; });
}

// To sleepers that something touches.
std::vector<Call> Dynamics::calls(const Step& step) const {
  std::vector<Call> list;
  for (const Manifold& m : found_) {
    if (!m.a->asleep && !m.b->asleep) continue;
    const ContactMemory* known = find(step.memory, m.pair);
    if (deepest(m) - (known ? known->tolerated : 0) > deepest_rest(*m.a, *m.b)) {
      list.push_back({m.a->id, make_room(*m.a)});
      list.push_back({m.b->id, make_room(*m.b)});
    }
    for (const Contact& contact : m.contacts) {
      const Vec3 relative = velocity_at(*m.a->object, contact.on_a) - velocity_at(*m.b->object, contact.on_b);
      const double touching = touching_share * std::min(m.a->radius, m.b->radius);
      if (contact.distance > std::max(touching, -relative.dot(contact.normal) * step.length)) continue;
      list.push_back({m.a->id, speed_set(*m.a, *m.b, relative.norm())});
      list.push_back({m.b->id, speed_set(*m.b, *m.a, relative.norm())});
    }
  }
  return list;
}

// Fills Bullet's manifolds. A pair with a newborn starts with its whole overlap tolerated; from then on what is
// tolerated only shrinks.
void Dynamics::load(const Step& step) {
  prepared_.clear();
  next_contacts_.clear();
  used_ = 0;
  for (const Manifold& m : found_) {
    if (used_ == manifolds_.size())
      manifolds_.push_back(std::make_unique<btPersistentManifold>(nullptr, nullptr, 0, BT_LARGE_FLOAT, BT_LARGE_FLOAT));
    btPersistentManifold& manifold = *manifolds_[used_++];
    manifold.clearManifold();
    manifold.setBodies(m.a->object.get(), m.b->object.get());
    const ContactMemory* before = find(step.memory, m.pair);
    std::vector<ContactMemory::Point> old = before ? before->points : std::vector<ContactMemory::Point>{};
    const double same_point = same_point_share * std::min(m.a->radius, m.b->radius), overlap = deepest(m);
    const bool at_birth = m.a->newborn || m.b->newborn;
    const double tolerance = at_birth ? overlap : before ? std::min(before->tolerated, overlap) : 0;
    next_contacts_.push_back({m.pair, std::max(tolerance, 0.0), {}});
    for (const Contact& contact : m.contacts) {
      btManifoldPoint point = to_point(contact, m.a->object->getWorldTransform(), m.b->object->getWorldTransform());
      point.m_appliedImpulse = inherited(to_eigen(point.m_localPointA), old, same_point);
      manifold.addManifoldPoint(point, true);
    }
    prepare(manifold, next_contacts_.back().tolerated, step);
  }
}

// Finds the points that touch or will touch before the step is over. One that hits does so at its own time within the
// step, so that neither restitution nor impulse nor place depend on how the steps fall.
void Dynamics::prepare(btPersistentManifold& manifold, double tolerance, const Step& step) {
  const Body &a = body_of(*manifold.getBody0()), &b = body_of(*manifold.getBody1());
  const double touching = touching_share * std::min(a.radius, b.radius);
  const double resting = resting_steps * gravity_.norm() * step.length;
  const Vec3 acceleration = acceleration_of(a) - acceleration_of(b);
  for (int i = 0; i < manifold.getNumContacts(); ++i) {
    btManifoldPoint& point = manifold.getContactPoint(i);
    const Vec3 normal = to_eigen(point.m_normalWorldOnB);
    const Vec3 relative = velocity_at(*a.object, to_eigen(point.m_positionWorldOnA)) -
                          velocity_at(*b.object, to_eigen(point.m_positionWorldOnB));
    Prepared p{&manifold, &point, normal, -relative.dot(normal), point.getDistance()};
    p.gap = p.distance + tolerance;
    p.pull = -acceleration.dot(normal);
    p.now = p.approach - (gain(a, 0) - gain(b, 0)).dot(normal);
    p.closing = p.approach - (gain(a, step.length / 2) - gain(b, step.length / 2)).dot(normal);
    p.acts = p.gap <= std::max(touching, p.closing * step.length);
    p.hits = p.acts && p.approach > resting;
    p.hit_time = p.hits ? std::clamp(p.gap / p.closing, 0.0, step.length) : 0;
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
void Dynamics::apply(const Prepared& p, const Step& step) {
  const Body &a = body_of(*p.manifold->getBody0()), &b = body_of(*p.manifold->getBody1());
  p.point->setDistance(!p.acts ? out_of_reach : p.hits ? std::min(p.gap, 0.0) : p.gap);
  p.point->m_combinedFriction = std::sqrt(a.friction * b.friction);
  p.point->m_combinedRestitution = 0;
  // A push within a short sub-step is no measure of what a long one needs: scaled up, it would throw bodies about.
  const double last_step = (a.is_dynamic() ? a : b).last_step;
  p.point->m_appliedImpulse *= p.acts ? std::min(1.0, step.length / last_step) : 0;
  if (!p.hits) return;
  const Fall fall{p.now, p.pull, std::max(p.gap, 0.0), step.length};
  p.point->m_combinedRestitution = leaving_speed(fall, a.restitution * b.restitution, p.hit_time) / p.approach;
}

// Moves bodies that hit to where they do; the rest of the step takes them on from there.
void Dynamics::move_to_hits(const Step& step) {
  for (Body* body : step.bodies)
    if (std::isfinite(body->hit_time) && body->is_awake()) integrate(*body, body->hit_time);
  for (const Prepared& p : prepared_) {
    p.point->m_positionWorldOnA = p.manifold->getBody0()->getWorldTransform() * p.point->m_localPointA;
    p.point->m_positionWorldOnB = p.manifold->getBody1()->getWorldTransform() * p.point->m_localPointB;
  }
}

// All awake bodies in one group: islands do not act on each other, so nothing is gained by solving them apart.
void Dynamics::run_solver(const std::vector<Body*>& awake, double length) {
  btAlignedObjectArray<btCollisionObject*> objects;
  for (Body* body : awake) {
    objects.push_back(body->object.get());
    if (body->is_dynamic()) body->object->applyCentralForce(to_bullet(gain(*body, length / 2) * (body->mass / length)));
  }
  btAlignedObjectArray<btPersistentManifold*> manifolds;
  for (std::size_t i = 0; i < used_; ++i) manifolds.push_back(manifolds_[i].get());
  info_.m_timeStep = length;
  solver_.solveGroup(&objects[0], objects.size(), manifolds.size() > 0 ? &manifolds[0] : nullptr, manifolds.size(),
                     nullptr, 0, info_, nullptr, nullptr);
  for (Body* body : awake) body->object->clearForces();
}

// Where several points of a body hit at once, Newton's law and friction can push harder together than what came in, and
// pushes of a hit that is over are a bad guess for wedged bodies: they would throw each other up, faster in each step.
// A solve that made energy is taken back and repeated from nothing and without restitution, where no row of the solver
// can add any.
void Dynamics::solve(const Step& step) {
  std::vector<Body*> awake;
  std::copy_if(step.bodies.begin(), step.bodies.end(), std::back_inserter(awake),
               [](const Body* body) { return body->is_awake(); });
  if (awake.empty()) return;
  double bounce = 0;
  for (const Prepared& p : prepared_)
    if (p.hits)
      bounce =
          std::max(bounce, body_of(*p.manifold->getBody0()).restitution * body_of(*p.manifold->getBody1()).restitution);
  // What is driven does work.
  const bool driven =
      std::any_of(awake.begin(), awake.end(), [](const Body* body) { return body->motion == Motion::kinematic; });
  if (bounce == 0 || driven) {
    run_solver(awake, step.length);
  } else {
    double allowed = 0, energy = 0;
    for (const Body* body : awake) allowed += energy_of(*body, gain(*body, step.length / 2));
    const std::vector<Start> starts = starts_of(awake);
    run_solver(awake, step.length);
    for (const Body* body : awake) energy += energy_of(*body, Vec3::Zero());
    if (energy > (1 + most_gain * bounce * bounce) * allowed) {
      for (std::size_t i = 0; i < awake.size(); ++i) restore(starts[i], *awake[i]->object);
      for (const Prepared& p : prepared_) {
        p.point->m_combinedRestitution = 0;
        p.point->m_appliedImpulse = p.point->m_appliedImpulseLateral1 = p.point->m_appliedImpulseLateral2 = 0;
      }
      run_solver(awake, step.length);
    }
  }
  for (Body* body : awake)
    if (body->is_dynamic()) take_over_turn(*body);
}

// Logs the impulses and keeps what the next sub-step starts from. The impulse of a hit is no guess for it.
void Dynamics::harvest(const Step& step) {
  std::size_t manifold = 0;
  for (const Prepared& p : prepared_) {
    while (manifolds_[manifold].get() != p.manifold) ++manifold;
    const Body &a = body_of(*p.manifold->getBody0()), &b = body_of(*p.manifold->getBody1());
    const Vec3 where = to_eigen((p.point->m_positionWorldOnA + p.point->m_positionWorldOnB) / 2);
    const double impulse = p.point->m_appliedImpulse;
    if (p.acts && impulse > 0)
      step.log.samples.push_back({a.id, b.id, where, p.normal, arm_of(a, where), arm_of(b, where), impulse, p.approach,
                                  patch_share * std::min(a.radius, b.radius), step.log.sub_step});
    next_contacts_[manifold].points.push_back({to_eigen(p.point->m_localPointA), p.hits ? 0 : impulse});
  }
  // Pairs of sleepers were not looked at.
  const auto sleeps = [&](BodyId id) {
    const Body* body = find_body(step.bodies, id);
    return !body || !body->is_awake();
  };
  for (const ContactMemory& old : step.memory)
    if (sleeps(old.pair.body_a) && sleeps(old.pair.body_b)) next_contacts_.push_back(old);
  std::sort(next_contacts_.begin(), next_contacts_.end(),
            [](const ContactMemory& m, const ContactMemory& n) { return m.pair < n.pair; });
  step.memory.swap(next_contacts_);
}

void Dynamics::advance(const std::vector<Body*>& bodies, Body* ground, double time_step,
                       std::vector<ContactMemory>& memory, ContactLog& log, StepWork& work) {
  const Step step{bodies, ground, time_step, memory, log};
  for (Body* body : bodies) {
    body->part_boxes = part_bounds(*body);
    body->box.setEmpty();
    for (const Box& box : body->part_boxes) body->box.extend(box);
    body->reach = reach_of(*body, gravity_.norm(), time_step);
    body->hit_time = std::numeric_limits<double>::infinity();
  }
  {
    const Stopwatch watch(work.search_seconds);
    find_contacts(step);
  }
  {
    const Stopwatch watch(work.solve_seconds);
    load(step);
    keep_first_hits();
    for (const Prepared& p : prepared_) apply(p, step);
    move_to_hits(step);
    solve(step);
  }
  work.contacts += static_cast<long>(prepared_.size());
  std::vector<Touch> touching;
  for (const Prepared& p : prepared_) {
    Body &a = body_of(*p.manifold->getBody0()), &b = body_of(*p.manifold->getBody1());
    if (p.acts) touching.push_back({&a, &b, -p.gap > deepest_rest(a, b)});
  }
  harvest(step);
  for (Body* body : bodies) {
    if (body->is_awake()) integrate(*body, time_step - (std::isfinite(body->hit_time) ? body->hit_time : 0));
    body->newborn = false;
    body->last_step = time_step;
  }
  let_sleep(touching, bodies, time_step);
}

}  // namespace sunder::rigid::detail
