#include "rigid/world.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <string>

#include "core/error.h"
#include "rigid/detail/dynamics.h"
#include "rigid/detail/encounters.h"
#include "rigid/detail/sleep.h"

namespace sunder::rigid {

using detail::Body;

// Lengths stay in metres inside: in double precision Bullet's distance routines are good to 1e-12 m, and everything in
// it that is meant for bodies of a metre (margins, breaking and sleeping thresholds, widened boxes, restitution
// threshold) is replaced by a share of the body's own size in detail/.
struct World::Impl {
  struct Member {
    BodySetup setup;
    std::unique_ptr<Body> body;
  };

  explicit Impl(const WorldSettings& chosen)
      : settings(chosen), ground(chosen.has_ground ? detail::make_ground(chosen) : nullptr), dynamics(chosen.gravity) {}

  WorldSettings settings;
  std::unique_ptr<Body> ground;
  std::map<BodyId, Member> members;
  std::vector<ContactMemory> contacts;  ///< in order of their pairs
  detail::Dynamics dynamics;
  StepWork work;
  BodyId next_id = 0;
  double time = 0;

  Body& at(BodyId id) const;
  std::vector<Body*> list() const;
  void add(BodyId id, const BodySetup& setup) {
    Body& body = *members.emplace(id, Member{setup, detail::make_body(id, setup, settings.gravity)}).first->second.body;
    body.last_step = settings.time_step;
  }
  std::vector<std::vector<ContactMemory>> take_contacts(std::size_t group_count, const std::vector<Body*>& bodies);
};

Body& World::Impl::at(BodyId id) const {
  const auto found = members.find(id);
  if (found == members.end()) throw Error(ErrorKind::internal, "rigid world has no body " + std::to_string(id));
  return *found->second.body;
}

std::vector<Body*> World::Impl::list() const {
  std::vector<Body*> result;
  for (const auto& [id, member] : members) result.push_back(member.body.get());
  return result;
}

/// Takes the contacts of each group out of the memory; those of sleepers stay. What stands still may be in several
/// groups, but its contacts are with bodies that are in one.
std::vector<std::vector<ContactMemory>> World::Impl::take_contacts(std::size_t group_count,
                                                                   const std::vector<Body*>& bodies) {
  std::vector<std::vector<ContactMemory>> taken(group_count);
  std::erase_if(contacts, [&](ContactMemory& contact) {
    for (const BodyId id : {contact.pair.body_a, contact.pair.body_b}) {
      const Body* body = detail::find_body(bodies, id);
      if (!body || body->group < 0) continue;
      taken[static_cast<std::size_t>(body->group)].push_back(std::move(contact));
      return true;
    }
    return false;
  });
  return taken;
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
double excess(const Body& a, const Body& b, const std::vector<ContactMemory>& contacts) {
  if (a.newborn || b.newborn) return 0;
  double depth = 0;
  for (const detail::PartOverlap& part : detail::part_overlaps(a, b)) {
    const ContactMemory* known = detail::find(contacts, {a.id, b.id, part.part_a, part.part_b});
    depth = std::max(depth, part.depth - (known ? known->tolerated : 0));
  }
  return depth;
}

// Rounding of positions, not overlap.
constexpr double overlap_noise = 1e-9;

}  // namespace

World::World(const WorldSettings& settings) {
  check(settings);
  impl_ = std::make_unique<Impl>(settings);
}

World::World(const WorldSettings& settings, const State& state) : World(settings) {
  for (std::size_t i = 0; i < state.setups.size(); ++i) impl_->add(state.snapshot.ids[i], state.setups[i]);
  impl_->next_id = state.next_id;
  restore(state.snapshot);
}

World::~World() = default;
World::World(World&&) noexcept = default;
World& World::operator=(World&&) noexcept = default;

BodyId World::add(const BodySetup& setup) {
  impl_->add(impl_->next_id, setup);
  return impl_->next_id++;
}

void World::remove(BodyId id) {
  impl_->at(id);
  detail::wake(detail::call_neighbours(id, impl_->contacts), impl_->contacts, impl_->list());
  impl_->members.erase(id);
  std::erase_if(impl_->contacts, [&](const ContactMemory& m) { return m.pair.body_a == id || m.pair.body_b == id; });
}

BodyState World::state(BodyId id) const { return detail::state_of(impl_->at(id)); }

void World::set_state(BodyId id, const BodyState& state) {
  Body& body = impl_->at(id);
  detail::wake(detail::call_neighbours(id, impl_->contacts), impl_->contacts, impl_->list());
  if (body.is_dynamic() && body.asleep) detail::set_asleep(body, false);
  detail::place(body, state);
}

void World::drive(BodyId id, const Pose& pose) {
  Body& body = impl_->at(id);
  if (body.motion != Motion::kinematic)
    throw Error(ErrorKind::internal, "rigid body " + std::to_string(id) + " is not kinematic and cannot be driven");
  BodyState state = detail::state_of(body);
  const Eigen::AngleAxisd turn(pose.orientation * state.pose.orientation.conjugate());
  state.twist.linear = (pose.position - state.pose.position) / impl_->settings.time_step;
  state.twist.angular = turn.axis() * (turn.angle() / impl_->settings.time_step);
  const bool starts = body.asleep;
  detail::place(body, state);
  if (starts && !body.asleep)
    detail::wake(detail::call_neighbours(id, impl_->contacts), impl_->contacts, impl_->list());
}

double World::mass(BodyId id) const { return impl_->at(id).mass; }

Mat3 World::world_inertia(BodyId id) const { return detail::world_inertia(impl_->at(id)); }

std::vector<BodyId> World::bodies() const {
  std::vector<BodyId> ids;
  for (const auto& [id, member] : impl_->members) ids.push_back(id);
  return ids;
}

double World::time() const { return impl_->time; }

std::vector<Impact> World::step() {
  const WorldSettings& settings = impl_->settings;
  const std::vector<Body*> bodies = impl_->list();
  detail::ContactLog log;
  impl_->work = {.steps = 1};
  const auto groups = detail::groups(bodies, impl_->ground.get(), settings.gravity, settings.time_step);
  auto contacts_of_groups = impl_->take_contacts(groups.size(), bodies);
  for (std::size_t g = 0; g < groups.size(); ++g) {
    const detail::Group& group = groups[g];
    std::vector<ContactMemory>& contacts = contacts_of_groups[g];
    for (log.sub_step = 0; log.sub_step < group.sub_steps; ++log.sub_step)
      impl_->dynamics.advance(group.bodies, impl_->ground.get(), settings.time_step / group.sub_steps, contacts, log,
                              impl_->work);
    impl_->work.sub_steps += group.sub_steps;
    impl_->work.body_sub_steps += group.sub_steps * static_cast<long>(group.bodies.size());
    std::move(contacts.begin(), contacts.end(), std::back_inserter(impl_->contacts));
  }
  std::sort(impl_->contacts.begin(), impl_->contacts.end(),
            [](const ContactMemory& m, const ContactMemory& n) { return m.pair < n.pair; });
  impl_->time += settings.time_step;
  for (const Body* body : bodies) check_finite(*body, impl_->time);
  return detail::impacts(std::move(log.samples), settings.resting_speed);
}

const StepWork& World::work() const { return impl_->work; }

StepWork& StepWork::operator+=(const StepWork& other) {
  steps += other.steps;
  sub_steps += other.sub_steps;
  body_sub_steps += other.body_sub_steps;
  contacts += other.contacts;
  search_seconds += other.search_seconds;
  solve_seconds += other.solve_seconds;
  return *this;
}

World::Snapshot World::snapshot() const {
  Snapshot snapshot;
  snapshot.time = impl_->time;
  for (const Body* body : impl_->list()) {
    snapshot.ids.push_back(body->id);
    snapshot.states.push_back(detail::state_of(*body));
    snapshot.turns.push_back(body->turn);
    snapshot.rests.push_back({body->asleep, body->quiet_time, body->last_step, body->newborn});
  }
  snapshot.contacts = impl_->contacts;
  return snapshot;
}

void World::restore(const Snapshot& snapshot) {
  impl_->time = snapshot.time;
  impl_->contacts = snapshot.contacts;
  std::erase_if(impl_->contacts, [&](const ContactMemory& m) {
    return !impl_->members.contains(m.pair.body_a) ||
           (m.pair.body_b != ground_id && !impl_->members.contains(m.pair.body_b));
  });
  for (std::size_t i = 0; i < snapshot.ids.size(); ++i) {
    const auto found = impl_->members.find(snapshot.ids[i]);
    if (found == impl_->members.end()) continue;
    Body& body = *found->second.body;
    if (body.is_dynamic()) detail::set_asleep(body, snapshot.rests[i].asleep);
    detail::place(body, snapshot.states[i]);
    detail::set_place(body, snapshot.states[i].pose.position, snapshot.turns[i]);
    body.quiet_time = snapshot.rests[i].quiet_time;
    body.last_step = snapshot.rests[i].last_step;
    body.newborn = snapshot.rests[i].newborn;
  }
}

World::State World::state() const {
  State state{{}, snapshot(), impl_->next_id};
  for (const auto& [id, member] : impl_->members) state.setups.push_back(member.setup);
  return state;
}

std::vector<World::Overlap> World::overlaps() const {
  const std::vector<Body*> bodies = impl_->list();
  std::vector<Box> boxes;
  for (const Body* body : bodies) boxes.push_back(detail::bounds(*body));
  std::vector<Overlap> result;
  const auto note = [&](const Body& a, const Body& b) {
    if (!a.is_dynamic() && !b.is_dynamic()) return;
    const double depth = excess(a, b, impl_->contacts);
    if (depth > overlap_noise * std::min(a.radius, b.radius)) result.push_back({a.id, b.id, depth});
  };
  for (const auto& [i, j] : detail::touching(boxes)) note(*bodies[i], *bodies[j]);
  for (const Body* body : bodies)
    if (impl_->ground) note(*body, *impl_->ground);
  std::stable_sort(result.begin(), result.end(), [](const Overlap& x, const Overlap& y) { return x.depth > y.depth; });
  return result;
}

}  // namespace sunder::rigid
