#include "rigid/detail/sleep.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace sunder::rigid::detail {
namespace {

// A body that was slow for so long may sleep [s].
constexpr double quiet_time = 0.5;
// Of the smaller radius.
constexpr double resting_depth = 4e-3;
// Share of a call that a woken body passes on.
constexpr double passed_on = 0.5;
constexpr double infinite = std::numeric_limits<double>::infinity();

}  // namespace

double speed_set(const Body& sleeper, const Body& other, double speed) {
  if (!sleeper.asleep || !sleeper.is_dynamic() || !other.is_awake()) return 0;
  return other.is_dynamic() ? std::min(1.0, other.mass / sleeper.mass) * speed : speed;
}

std::vector<Call> call_neighbours(BodyId id, const std::vector<ContactMemory>& contacts) {
  std::vector<Call> calls;
  for (const ContactMemory& contact : contacts) {
    if (contact.pair.body_a == id) calls.push_back({contact.pair.body_b, infinite});
    if (contact.pair.body_b == id) calls.push_back({contact.pair.body_a, infinite});
  }
  return calls;
}

bool wake(std::vector<Call> calls, const std::vector<ContactMemory>& contacts, const std::vector<Body*>& bodies) {
  const auto answers = [&](const Call& call) -> Body* {
    Body* body = find_body(bodies, call.id);
    return body && body->is_dynamic() && body->asleep && call.speed > body->slow_speed ? body : nullptr;
  };
  std::erase_if(calls, [&](const Call& call) { return !answers(call); });
  if (calls.empty()) return false;
  std::vector<std::pair<BodyId, BodyId>> neighbours;
  for (const ContactMemory& contact : contacts) {
    neighbours.emplace_back(contact.pair.body_a, contact.pair.body_b);
    neighbours.emplace_back(contact.pair.body_b, contact.pair.body_a);
  }
  std::sort(neighbours.begin(), neighbours.end());
  neighbours.erase(std::unique(neighbours.begin(), neighbours.end()), neighbours.end());
  // The loudest first: whom a weaker call leaves asleep may still hear a stronger one.
  const auto weaker = [](const Call& a, const Call& b) { return std::pair(a.speed, b.id) < std::pair(b.speed, a.id); };
  std::make_heap(calls.begin(), calls.end(), weaker);
  while (!calls.empty()) {
    std::pop_heap(calls.begin(), calls.end(), weaker);
    const Call call = calls.back();
    calls.pop_back();
    Body* body = answers(call);
    if (!body) continue;
    set_asleep(*body, false);
    const auto first = std::lower_bound(neighbours.begin(), neighbours.end(), std::pair(call.id, ground_id));
    for (auto n = first; n != neighbours.end() && n->first == call.id; ++n) {
      const Body* neighbour = find_body(bodies, n->second);
      if (!neighbour) continue;
      calls.push_back({n->second, speed_set(*neighbour, *body, passed_on * call.speed)});
      std::push_heap(calls.begin(), calls.end(), weaker);
    }
  }
  return true;
}

double deepest_rest(const Body& a, const Body& b) { return resting_depth * std::min(a.radius, b.radius); }

double make_room(const Body& sleeper) { return 4 * sleeper.slow_speed; }

void let_sleep(const std::vector<Touch>& touching, const std::vector<Body*>& bodies, double time_step) {
  for (Body* body : bodies)
    if (body->is_dynamic() && !body->asleep) body->quiet_time = is_slow(*body) ? body->quiet_time + time_step : 0;
  std::vector<const Body*> disturbed;
  for (const auto& [a, b, deep] : touching) {
    if (deep || (b->is_awake() && !(b->quiet_time > 0))) disturbed.push_back(a);
    if (deep || (a->is_awake() && !(a->quiet_time > 0))) disturbed.push_back(b);
  }
  std::sort(disturbed.begin(), disturbed.end());
  for (Body* body : bodies) {
    if (!body->is_dynamic() || body->asleep || body->quiet_time <= quiet_time) continue;
    if (!std::binary_search(disturbed.begin(), disturbed.end(), body)) set_asleep(*body, true);
  }
}

}  // namespace sunder::rigid::detail
