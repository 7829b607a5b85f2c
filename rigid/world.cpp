#include "rigid/world.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <string>

#include "core/error.h"
#include "rigid/detail/dynamics.h"
#include "rigid/detail/encounters.h"

namespace sunder::rigid {

using detail::Body;

// Lengths stay in metres inside: in double precision Bullet's distance routines are good to 1e-12 m, and everything in
// it that is meant for bodies of a metre (margins, breaking and sleeping thresholds, widened boxes, restitution
// threshold) is replaced by a share of the body's own size in detail/.
struct World::Impl {
  WorldSettings settings;
  std::unique_ptr<Body> ground;
  std::map<BodyId, std::unique_ptr<Body>> bodies;
  detail::Tolerances tolerances;
  detail::ContactLog log;
  std::optional<detail::Simulation> simulation;
  BodyId next_id = 0;
  double time = 0;

  Body& at(BodyId id) const;
  void restart(double last_step);
  std::vector<const Body*> list() const;
};

Body& World::Impl::at(BodyId id) const {
  const auto found = bodies.find(id);
  if (found == bodies.end()) throw Error(ErrorKind::internal, "rigid world has no body " + std::to_string(id));
  return *found->second;
}

// A new simulation with the same bodies in the order of their ids: forgets contacts and the order in which things
// happened.
void World::Impl::restart(double last_step) {
  simulation.reset();
  simulation.emplace(settings, last_step, tolerances, log);
  if (ground) simulation->insert(*ground);
  for (const auto& [id, body] : bodies) simulation->insert(*body);
}

std::vector<const Body*> World::Impl::list() const {
  std::vector<const Body*> result;
  for (const auto& [id, body] : bodies) result.push_back(body.get());
  return result;
}

namespace {

void check(const WorldSettings& settings) {
  const bool finite = settings.gravity.allFinite() && std::isfinite(settings.ground_height);
  if (!finite) throw Error(ErrorKind::usage, "rigid world: gravity and ground height have to be finite");
  if (!(std::isfinite(settings.time_step) && settings.time_step > 0))
    throw Error(ErrorKind::usage, "rigid world: the time step has to be positive and finite");
  if (!(settings.ground_restitution >= 0 && settings.ground_restitution <= 1 && settings.ground_friction >= 0))
    throw Error(ErrorKind::usage,
                "rigid world: ground restitution has to lie in [0, 1], ground friction must not be negative");
}

void check_finite(const Body& body, double time) {
  const BodyState state = detail::state_of(body);
  if (state.pose.position.allFinite() && state.pose.orientation.coeffs().allFinite() &&
      state.twist.linear.allFinite() && state.twist.angular.allFinite())
    return;
  throw Error(ErrorKind::unstable, "rigid body " + std::to_string(body.id) + " left all finite numbers at t = " +
                                       std::to_string(time) + " s; a smaller rigid time step may help");
}

// What is not tolerated of the overlaps of two bodies.
double excess(const Body& a, const Body& b, const detail::Tolerances& tolerances) {
  if (a.newborn || b.newborn) return 0;
  double depth = 0;
  for (const detail::PartOverlap& part : detail::part_overlaps(a, b)) {
    const auto tolerated = tolerances.find({a.id, b.id, part.part_a, part.part_b});
    depth = std::max(depth, part.depth - (tolerated == tolerances.end() ? 0 : tolerated->second));
  }
  return depth;
}

// Rounding of positions, not overlap.
constexpr double overlap_noise = 1e-9;

}  // namespace

World::World(const WorldSettings& settings) : impl_(std::make_unique<Impl>()) {
  check(settings);
  impl_->settings = settings;
  if (settings.has_ground) impl_->ground = detail::make_ground(settings);
  impl_->restart(settings.time_step);
}

World::~World() = default;
World::World(World&&) noexcept = default;
World& World::operator=(World&&) noexcept = default;

BodyId World::add(const BodySetup& setup) {
  const BodyId id = impl_->next_id;
  auto body = detail::make_body(id, setup, impl_->settings.gravity);
  impl_->simulation->insert(*body);
  impl_->bodies.emplace(id, std::move(body));
  ++impl_->next_id;
  return id;
}

void World::remove(BodyId id) {
  impl_->simulation->erase(impl_->at(id));
  impl_->bodies.erase(id);
  std::erase_if(impl_->tolerances,
                [&](const auto& entry) { return entry.first.body_a == id || entry.first.body_b == id; });
}

BodyState World::state(BodyId id) const { return detail::state_of(impl_->at(id)); }

void World::set_state(BodyId id, const BodyState& state) {
  Body& body = impl_->at(id);
  detail::place(body, state);
  if (body.is_dynamic()) body.object->activate(true);
  impl_->simulation->wake_neighbours(body);
}

double World::mass(BodyId id) const { return impl_->at(id).mass; }

Mat3 World::world_inertia(BodyId id) const { return detail::world_inertia(impl_->at(id)); }

std::vector<BodyId> World::bodies() const {
  std::vector<BodyId> ids;
  for (const auto& [id, body] : impl_->bodies) ids.push_back(id);
  return ids;
}

double World::time() const { return impl_->time; }

std::vector<Impact> World::step() {
  const WorldSettings& settings = impl_->settings;
  const int pieces = detail::sub_steps(impl_->list(), impl_->ground.get(), settings.gravity, settings.time_step);
  impl_->log.samples.clear();
  for (int i = 0; i < pieces; ++i) {
    impl_->log.sub_step = i;
    impl_->simulation->advance(settings.time_step / pieces);
  }
  impl_->time += settings.time_step;
  for (const auto& [id, body] : impl_->bodies) check_finite(*body, impl_->time);
  return detail::impacts(impl_->log.samples, settings.resting_speed);
}

World::Snapshot World::snapshot() const {
  Snapshot snapshot;
  snapshot.time = impl_->time;
  snapshot.last_step = impl_->simulation->last_step();
  for (const auto& [id, body] : impl_->bodies) {
    const btRigidBody& object = *body->object;
    snapshot.ids.push_back(id);
    snapshot.states.push_back(detail::state_of(*body));
    snapshot.rests.push_back({object.getActivationState(), object.getDeactivationTime(), body->newborn});
  }
  for (const auto& [pair, depth] : impl_->tolerances)
    snapshot.tolerances.push_back({pair.body_a, pair.body_b, pair.part_a, pair.part_b, depth});
  return snapshot;
}

void World::restore(const Snapshot& snapshot) {
  impl_->time = snapshot.time;
  impl_->tolerances.clear();
  for (const Snapshot::Tolerance& t : snapshot.tolerances)
    impl_->tolerances[{t.body_a, t.body_b, t.part_a, t.part_b}] = t.depth;
  for (std::size_t i = 0; i < snapshot.ids.size(); ++i) {
    const auto found = impl_->bodies.find(snapshot.ids[i]);
    if (found == impl_->bodies.end()) continue;
    Body& body = *found->second;
    detail::place(body, snapshot.states[i]);
    body.object->forceActivationState(snapshot.rests[i].activation);
    body.object->setDeactivationTime(snapshot.rests[i].quiet_time);
    body.newborn = snapshot.rests[i].newborn;
  }
  impl_->restart(snapshot.last_step);
}

std::vector<World::Overlap> World::overlaps() const {
  const std::vector<const Body*> bodies = impl_->list();
  std::vector<Box> boxes;
  for (const Body* body : bodies) boxes.push_back(detail::bounds(*body));
  std::vector<Overlap> result;
  const auto note = [&](const Body& a, const Body& b) {
    if (!a.is_dynamic() && !b.is_dynamic()) return;
    const double depth = excess(a, b, impl_->tolerances);
    if (depth > overlap_noise * std::min(a.radius, b.radius)) result.push_back({a.id, b.id, depth});
  };
  for (const auto& [i, j] : detail::touching(boxes)) note(*bodies[i], *bodies[j]);
  for (const Body* body : bodies)
    if (impl_->ground) note(*body, *impl_->ground);
  std::stable_sort(result.begin(), result.end(), [](const Overlap& x, const Overlap& y) { return x.depth > y.depth; });
  return result;
}

}  // namespace sunder::rigid
