#include "pipeline/handover.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

namespace sunder::pipeline {
namespace {

/// Inertia of a point mass at r: m (|r|^2 I - r r^T).
Mat3 steiner(double mass, const Vec3& r) { return mass * (r.squaredNorm() * Mat3::Identity() - r * r.transpose()); }

/// All parts as one.
RigidPart merged(const std::vector<RigidPart>& parts) {
  RigidPart all;
  for (const RigidPart& p : parts) {
    all.mass += p.mass;
    all.centre += p.mass * p.centre;
  }
  all.centre /= all.mass;
  for (const RigidPart& p : parts) all.inertia += p.inertia + steiner(p.mass, p.centre - all.centre);
  return all;
}

}  // namespace

Momentum momentum(const std::vector<RigidPart>& parts, const std::vector<Twist>& twists) {
  Momentum m;
  for (std::size_t k = 0; k < parts.size(); ++k) {
    const Vec3 linear = parts[k].mass * twists[k].linear;
    m.linear += linear;
    m.angular += parts[k].centre.cross(linear) + parts[k].inertia * twists[k].angular;
  }
  return m;
}

double relative_difference(const Momentum& expected, const Momentum& found, const std::vector<RigidPart>& parts,
                           const std::vector<Twist>& twists) {
  double linear = expected.linear.norm(), angular = expected.angular.norm();
  for (std::size_t k = 0; k < parts.size(); ++k) {
    const Vec3 p = parts[k].mass * twists[k].linear;
    linear += p.norm();
    angular += parts[k].centre.cross(p).norm() + (parts[k].inertia * twists[k].angular).norm();
  }
  const auto share = [](double difference, double scale) { return difference > 0 ? difference / scale : 0; };
  return std::max(share((found.linear - expected.linear).norm(), linear),
                  share((found.angular - expected.angular).norm(), angular));
}

double kinetic_energy(const std::vector<RigidPart>& parts, const std::vector<Twist>& twists) {
  double energy = 0;
  for (std::size_t k = 0; k < parts.size(); ++k)
    energy += 0.5 * (parts[k].mass * twists[k].linear.squaredNorm() +
                     twists[k].angular.dot(parts[k].inertia * twists[k].angular));
  return energy;
}

std::vector<Twist> rigid_motion(const std::vector<RigidPart>& parts, const Momentum& total) {
  const RigidPart all = merged(parts);
  const Vec3 linear = total.linear / all.mass;
  const Vec3 angular = all.inertia.ldlt().solve(total.angular - all.centre.cross(total.linear));
  std::vector<Twist> twists;
  for (const RigidPart& p : parts) twists.push_back({linear + angular.cross(p.centre - all.centre), angular});
  return twists;
}

std::vector<Twist> with_momentum(const std::vector<RigidPart>& parts, std::vector<Twist> twists,
                                 const Momentum& total) {
  const Momentum now = momentum(parts, twists);
  const auto missing = rigid_motion(parts, {total.linear - now.linear, total.angular - now.angular});
  for (std::size_t k = 0; k < parts.size(); ++k) {
    twists[k].linear += missing[k].linear;
    twists[k].angular += missing[k].angular;
  }
  return twists;
}

std::vector<Twist> with_energy_limit(const std::vector<RigidPart>& parts, const std::vector<Twist>& twists,
                                     double limit) {
  if (kinetic_energy(parts, twists) <= limit) return twists;
  auto rigid = rigid_motion(parts, momentum(parts, twists));
  // The deviation carries no momentum, so energies of rigid motion and deviation add without a cross term.
  const double rigid_energy = kinetic_energy(parts, rigid), excess = kinetic_energy(parts, twists) - rigid_energy;
  const double scale = excess > 0 ? std::sqrt(std::max(0.0, limit - rigid_energy) / excess) : 0;
  for (std::size_t k = 0; k < parts.size(); ++k) {
    rigid[k].linear += scale * (twists[k].linear - rigid[k].linear);
    rigid[k].angular += scale * (twists[k].angular - rigid[k].angular);
  }
  return rigid;
}

namespace {

/// Energy of the motion that a momentum gives to a part at rest.
double response_energy(const RigidPart& part, const Momentum& m) {
  return 0.5 * (m.linear.squaredNorm() / part.mass + m.angular.dot(part.inertia.ldlt().solve(m.angular)));
}

}  // namespace

double affordable_share(const RigidPart& body, const Twist& body_twist, const std::vector<RigidPart>& partners,
                        const std::vector<Twist>& partner_twists, const std::vector<Push>& pushes) {
  // The energy over the share s is E(0) + power s + response s^2.
  double power = 0;
  Momentum on_body;
  std::vector<Momentum> on_partner(partners.size());
  for (const Push& push : pushes) {
    on_body.linear += push.impulse;
    on_body.angular += push.arm.cross(push.impulse);
    power += push.impulse.dot(body_twist.at(push.arm));
    if (push.partner < 0) continue;
    const std::size_t p = static_cast<std::size_t>(push.partner);
    on_partner[p].linear -= push.impulse;
    on_partner[p].angular -= push.partner_arm.cross(push.impulse);
    power -= push.impulse.dot(partner_twists[p].at(push.partner_arm));
  }
  double response = response_energy(body, on_body);
  for (std::size_t p = 0; p < partners.size(); ++p) response += response_energy(partners[p], on_partner[p]);
  return power + response > 0 ? std::clamp(-power / response, 0.0, 1.0) : 1.0;
}

double effective_mass(const RigidPart& part, const Vec3& arm, const Vec3& direction) {
  const Vec3 lever = arm.cross(direction);
  return 1 / (1 / part.mass + lever.dot(part.inertia.ldlt().solve(lever)));
}

}  // namespace sunder::pipeline
