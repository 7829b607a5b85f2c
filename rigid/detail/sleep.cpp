#include "rigid/detail/sleep.h"

#include <algorithm>
#include <numeric>

namespace sunder::rigid::detail {
namespace {

// A body that was slow for so long may sleep [s].
constexpr double quiet_time = 0.5;

/// Groups of bodies by their places in the list.
class Groups {
 public:
  explicit Groups(std::size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), 0); }
  int of(int i) {
    while (parent_[at(i)] != i) i = parent_[at(i)] = parent_[at(parent_[at(i)])];
    return i;
  }
  void join(int i, int j) { parent_[at(std::max(of(i), of(j)))] = std::min(of(i), of(j)); }

 private:
  static std::size_t at(int i) { return static_cast<std::size_t>(i); }
  std::vector<int> parent_;
};

/// Place in the list; -1 for the ground and for bodies that are gone.
int place_of(BodyId id, const std::vector<Body*>& bodies) {
  const auto found =
      std::lower_bound(bodies.begin(), bodies.end(), id, [](const Body* b, BodyId wanted) { return b->id < wanted; });
  return found != bodies.end() && (*found)->id == id ? static_cast<int>(found - bodies.begin()) : -1;
}

}  // namespace

bool rouses(const Body& sleeper, const Body& other, double speed) {
  if (!sleeper.asleep || !sleeper.is_dynamic() || !other.is_awake()) return false;
  const double share = other.is_dynamic() ? std::min(1.0, other.mass / sleeper.mass) : 1.0;
  return share * speed > sleeper.slow_speed;
}

std::vector<BodyId> touching(BodyId id, const std::vector<ContactMemory>& contacts) {
  std::vector<BodyId> ids;
  for (const ContactMemory& contact : contacts) {
    if (contact.pair.body_a == id) ids.push_back(contact.pair.body_b);
    if (contact.pair.body_b == id) ids.push_back(contact.pair.body_a);
  }
  return ids;
}

void wake(const std::vector<BodyId>& roused, const std::vector<ContactMemory>& contacts,
          const std::vector<Body*>& bodies) {
  Groups groups(bodies.size());
  for (const ContactMemory& contact : contacts) {
    const int a = place_of(contact.pair.body_a, bodies), b = place_of(contact.pair.body_b, bodies);
    if (a < 0 || b < 0) continue;
    const Body &first = *bodies[static_cast<std::size_t>(a)], &second = *bodies[static_cast<std::size_t>(b)];
    if (first.is_dynamic() && first.asleep && second.is_dynamic() && second.asleep) groups.join(a, b);
  }
  std::vector<bool> wakes(bodies.size(), false);
  for (BodyId id : roused)
    if (const int place = place_of(id, bodies); place >= 0) wakes[static_cast<std::size_t>(groups.of(place))] = true;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    Body& body = *bodies[i];
    if (body.is_dynamic() && body.asleep && wakes[static_cast<std::size_t>(groups.of(static_cast<int>(i)))])
      set_asleep(body, false);
  }
}

void let_sleep(const std::vector<std::pair<Body*, Body*>>& touching, const std::vector<Body*>& bodies,
               double time_step) {
  for (Body* body : bodies)
    if (body->is_dynamic() && !body->asleep) body->quiet_time = is_slow(*body) ? body->quiet_time + time_step : 0;
  Groups groups(bodies.size());
  for (const auto& [a, b] : touching) {
    for (const auto& [body, other] : {std::pair(a, b), std::pair(b, a)})
      if (body->is_dynamic() && other->motion == Motion::kinematic && other->is_awake()) body->quiet_time = 0;
    const int i = place_of(a->id, bodies), j = place_of(b->id, bodies);
    if (i >= 0 && j >= 0 && a->is_dynamic() && b->is_dynamic() && !a->asleep && !b->asleep) groups.join(i, j);
  }
  std::vector<bool> restless(bodies.size(), false);
  for (std::size_t i = 0; i < bodies.size(); ++i)
    if (bodies[i]->is_dynamic() && !bodies[i]->asleep && bodies[i]->quiet_time <= quiet_time)
      restless[static_cast<std::size_t>(groups.of(static_cast<int>(i)))] = true;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    Body& body = *bodies[i];
    if (body.is_dynamic() && !body.asleep && !restless[static_cast<std::size_t>(groups.of(static_cast<int>(i)))])
      set_asleep(body, true);
  }
}

}  // namespace sunder::rigid::detail
