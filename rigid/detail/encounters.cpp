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

Box swept(const Body& body, const StepMotion& motion) {
  Box box = bounds(body);
  const Box moved = box.translated(motion.shift);
  box.extend(moved);
  const Vec3 margin = Vec3::Constant(motion.sweep);
  return Box(box.min() - margin, box.max() + margin);
}

// Beside a large body a small one may take strides of this share of the large one's.
constexpr double stride_beside = 0.05;

/// How far two bodies move against each other in a step in which their bounding spheres meet [m]. Bodies that part, as
/// fragments do after a burst, count with their spins alone.
double motion_towards(const Body& a, const StepMotion& motion_a, const Body& b, const StepMotion& motion_b) {
  const Vec3 apart = to_eigen(a.object->getCenterOfMassPosition() - b.object->getCenterOfMassPosition());
  const Vec3 shift = motion_a.shift - motion_b.shift;
  const double reach = a.radius + b.radius, along = apart.dot(shift), length = shift.squaredNorm();
  const double nearest = length > 0 ? std::clamp(-along / length, 0.0, 1.0) : 0;
  if ((apart + nearest * shift).norm() > reach) return 0;
  return motion_a.sweep + motion_b.sweep + (along < 0 ? shift.norm() : 0);
}

double steps_for(double motion, double stride) { return std::ceil(motion / stride); }

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

int sub_steps(const std::vector<Body*>& bodies, const Body* ground, const Vec3& gravity, double time_step) {
  const double crumb = crumb_share * heaviest(bodies);
  const auto counts = [&](const Body& body) { return !body.is_dynamic() || body.mass >= crumb; };
  std::vector<StepMotion> motions;
  double farthest = 0, least_stride = std::numeric_limits<double>::infinity(), fastest_turn = 0;
  for (const Body* body : bodies) {
    motions.push_back(motion_of(*body, gravity, time_step));
    if (!counts(*body)) continue;
    farthest = std::max(farthest, motions.back().shift.norm() + motions.back().sweep);
    least_stride = std::min(least_stride, body->stride);
    fastest_turn = std::max(fastest_turn, motions.back().sweep / body->radius);
  }
  if (2 * farthest <= least_stride && fastest_turn <= turn_per_step) return 1;
  std::vector<Box> boxes;
  for (std::size_t i = 0; i < bodies.size(); ++i) boxes.push_back(swept(*bodies[i], motions[i]));
  double steps = 1;
  for (const auto& [i, j] : touching(boxes)) {
    if (!bodies[i]->is_dynamic() && !bodies[j]->is_dynamic()) continue;
    if (!counts(*bodies[i]) || !counts(*bodies[j])) continue;
    const auto [least, most] = std::minmax(bodies[i]->stride, bodies[j]->stride);
    const double motion = motion_towards(*bodies[i], motions[i], *bodies[j], motions[j]);
    steps = std::max(steps, steps_for(motion, std::max(least, stride_beside * most)));
  }
  for (std::size_t i = 0; ground && i < bodies.size(); ++i) {
    if (boxes[i].min().y() > ground->ground_height || !bodies[i]->is_dynamic() || !counts(*bodies[i])) continue;
    steps = std::max(steps, std::min(most_turns, steps_for(motions[i].sweep / bodies[i]->radius, turn_per_step)));
  }
  return static_cast<int>(std::min<double>(steps, most_sub_steps));
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
