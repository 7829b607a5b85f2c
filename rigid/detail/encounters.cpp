#include "rigid/detail/encounters.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "rigid/detail/contact.h"
#include "rigid/detail/convert.h"

namespace sunder::rigid::detail {
namespace {

// Beyond this a step would stall the run; a 5 mm fragment reaches it at about 300 m/s and 480 steps per second.
constexpr int most_sub_steps = 512;

// A plane is met where the contact search foresees it, however fast: only turning changes which corner meets it. A
// small ball that rolls away at high speed would otherwise make all others take its steps.
constexpr double turn_per_step = 1;  // [rad]
constexpr double most_turns = 8;

// Bodies lighter than this share of the heaviest are crumbs: they take the sub-steps that others need.
constexpr double crumb_share = 1e-6;

std::size_t at(int i) { return static_cast<std::size_t>(i); }

/// Which bodies hang together, by their places in the list.
class Joined {
 public:
  explicit Joined(std::size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), 0); }
  int of(int i) {
    while (parent_[at(i)] != i) i = parent_[at(i)] = parent_[at(parent_[at(i)])];
    return i;
  }
  void join(int i, int j) { parent_[at(std::max(of(i), of(j)))] = std::min(of(i), of(j)); }

 private:
  std::vector<int> parent_;
};

double heaviest(const std::vector<Body*>& bodies) {
  double mass = 0;
  for (const Body* body : bodies)
    if (body->is_dynamic()) mass = std::max(mass, body->mass);
  return mass;
}

struct StepMotion {
  Vec3 shift = Vec3::Zero();  // of the centre of mass in one step [m]
  double sweep = 0;           // of the outermost point by rotation [m]
};

StepMotion motion_of(const Body& body, const Vec3& gravity, double time_step) {
  const btRigidBody& object = *body.object;
  Vec3 shift = to_eigen(object.getLinearVelocity()) * time_step;
  if (body.is_dynamic() && !body.asleep) shift += gravity * (time_step * time_step);
  return {shift, object.getAngularVelocity().length() * body.radius * time_step};
}

/// Whatever turn its motion takes in the step, the body stays in it.
Box roomy(const Body& body, const StepMotion& motion) {
  constexpr double touching = 0.02;  // of the radius: bodies at rest on each other
  const Box box = bounds(body);
  const Vec3 margin = Vec3::Constant(motion.shift.norm() + motion.sweep + touching * body.radius);
  return Box(box.min() - margin, box.max() + margin);
}

// A body that turns beside another is followed this finely [rad].
constexpr double turn_beside = 0.5;

// Beside a large body a small one may take strides of this share of the large one's.
constexpr double stride_beside = 0.15;

double steps_for(double motion, double stride) { return std::ceil(motion / stride); }

/// Sub-steps for two bodies whose bounding spheres meet in the step. Bodies that part, as fragments do after a burst,
/// count with their spins alone, and what spins faster than it can be followed is as good as a disc.
double steps_for(const Body& a, const StepMotion& motion_a, const Body& b, const StepMotion& motion_b) {
  const Vec3 apart = to_eigen(a.object->getCenterOfMassPosition() - b.object->getCenterOfMassPosition());
  const Vec3 shift = motion_a.shift - motion_b.shift;
  const double reach = a.radius + b.radius, along = apart.dot(shift), length = shift.squaredNorm();
  const double nearest = length > 0 ? std::clamp(-along / length, 0.0, 1.0) : 0;
  if ((apart + nearest * shift).norm() > reach) return 1;
  const auto [least, largest] = std::minmax(a.stride, b.stride);
  const double stride = std::max(least, stride_beside * largest);
  const double turn = std::max(motion_a.sweep / a.radius, motion_b.sweep / b.radius);
  const double turning = std::min((motion_a.sweep + motion_b.sweep) / stride, turn / turn_beside);
  return std::ceil((along < 0 ? shift.norm() / stride : 0) + turning);
}

}  // namespace

std::vector<std::pair<int, int>> touching(const std::vector<Box>& boxes) {
  std::vector<int> order(boxes.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](int i, int j) { return boxes[i].min().x() < boxes[j].min().x(); });
  std::vector<std::pair<int, int>> pairs;
  for (std::size_t k = 0; k < order.size(); ++k) {
    const Box& box = boxes[order[k]];
    for (std::size_t l = k + 1; l < order.size() && boxes[order[l]].min().x() <= box.max().x(); ++l)
      if (box.intersects(boxes[order[l]])) pairs.emplace_back(std::minmax(order[k], order[l]));
  }
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

std::vector<Group> groups(const std::vector<Body*>& bodies, const Body* ground, const Vec3& gravity, double time_step) {
  std::vector<StepMotion> motions;
  std::vector<Box> boxes;
  for (const Body* body : bodies) {
    motions.push_back(motion_of(*body, gravity, time_step));
    boxes.push_back(roomy(*body, motions.back()));
  }
  const auto pairs = touching(boxes);
  const auto is_fixed = [&](int i) { return !bodies[at(i)]->is_dynamic() && !bodies[at(i)]->is_awake(); };
  Joined joined(bodies.size());
  for (const auto& [i, j] : pairs)
    if (!is_fixed(i) && !is_fixed(j)) joined.join(i, j);

  const double crumb = crumb_share * heaviest(bodies);
  const auto counts = [&](int i) { return !bodies[at(i)]->is_dynamic() || bodies[at(i)]->mass >= crumb; };
  std::vector<std::vector<int>> members(bodies.size());
  std::vector<double> steps(bodies.size(), 1);
  for (int i = 0; i < static_cast<int>(bodies.size()); ++i) {
    if (is_fixed(i)) continue;
    members[at(joined.of(i))].push_back(i);
    const bool lands = ground && bodies[at(i)]->is_dynamic() && boxes[at(i)].min().y() <= ground->ground_height;
    if (!lands || !counts(i)) continue;
    double& most = steps[at(joined.of(i))];
    most = std::max(most, std::min(most_turns, steps_for(motions[at(i)].sweep / bodies[at(i)]->radius, turn_per_step)));
  }
  for (const auto& [i, j] : pairs) {
    if (is_fixed(i) && is_fixed(j)) continue;
    const int group = joined.of(is_fixed(i) ? j : i);
    if (is_fixed(i)) members[at(group)].push_back(i);
    if (is_fixed(j)) members[at(group)].push_back(j);
    if (!counts(i) || !counts(j)) continue;
    const double needed = steps_for(*bodies[at(i)], motions[at(i)], *bodies[at(j)], motions[at(j)]);
    steps[at(group)] = std::max(steps[at(group)], needed);
  }

  std::vector<Group> result;
  for (std::size_t g = 0; g < bodies.size(); ++g) {
    std::sort(members[g].begin(), members[g].end());
    members[g].erase(std::unique(members[g].begin(), members[g].end()), members[g].end());
    Group group{{}, static_cast<int>(std::min<double>(steps[g], most_sub_steps))};
    for (int i : members[g]) group.bodies.push_back(bodies[at(i)]);
    const bool awake =
        std::any_of(group.bodies.begin(), group.bodies.end(), [](const Body* b) { return b->is_awake(); });
    for (int i : members[g]) bodies[at(i)]->group = awake && !is_fixed(i) ? static_cast<int>(result.size()) : -1;
    if (awake) result.push_back(std::move(group));
  }
  return result;
}

std::vector<Box> part_bounds(const Body& body) {
  std::vector<Box> boxes;
  for (const Hull& part : body.parts) {
    btVector3 low, high;
    part.shape->getAabb(body.object->getWorldTransform(), low, high);
    boxes.emplace_back(to_eigen(low), to_eigen(high));
  }
  return boxes;
}

std::vector<PartOverlap> part_overlaps(const Body& a, const Body& b) {
  const btTransform &place_a = a.object->getWorldTransform(), &place_b = b.object->getWorldTransform();
  std::vector<PartOverlap> overlaps;
  const auto note = [&](int i, int j, const std::vector<Contact>& list) {
    if (!list.empty() && list.front().distance < 0) overlaps.push_back({i, j, -list.front().distance});
  };
  const std::vector<Box> boxes_a = part_bounds(a), boxes_b = part_bounds(b);
  for (int i = 0; i < static_cast<int>(a.parts.size()); ++i) {
    if (b.is_ground()) note(i, 0, contacts_with_plane(a.parts[i], place_a, b.ground_height, 0));
    for (int j = 0; j < static_cast<int>(b.parts.size()); ++j)
      if (boxes_a[i].intersects(boxes_b[j])) note(i, j, contacts(a.parts[i], place_a, b.parts[j], place_b, 0));
  }
  return overlaps;
}

}  // namespace sunder::rigid::detail
