#include "mpm/contact_load.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace sunder::mpm {

double reduced_mass(double body_mass, double partner_mass) {
  return std::isinf(partner_mass) ? body_mass : body_mass * partner_mass / (body_mass + partner_mass);
}

double impact_duration(double m, double v, const ContactPair& pair) {
  // The elastic duration is the shortest: crushing only lowers the force and stretches the way to the turn.
  const double dt = hertz_duration(m, v, pair) / 4000;
  HertzContact contact(pair);
  double d = 0, speed = v, time = 0;
  for (int step = 0; step < 400000; ++step) {
    const double force = contact.load(d);
    speed -= force / m * dt;
    d += speed * dt;
    time += dt;
    if (speed < 0 && contact.force(d) <= 0) break;
  }
  return time;
}

ContactLoad::ContactLoad(const Load& load, double body_mass, const Partner& partner, const Material& material,
                         const SolveSettings& settings, const Continuum& body)
    : load_(load),
      contact_(load.pair),
      model_(settings.load),
      patch_(body, load.point, load.outward, settings.smallest_patch * body.cell_size()) {
  // The patch of the solve already gives way by about 0.6 chi F / (E* a), chi the body's share of E*: the contact law
  // adds it back. That is 0.8 chi a_h / a of the elastic indentation, a_h the radius of the contact.
  const double share =
      load.pair.effective_modulus * (1 - material.poisson_ratio * material.poisson_ratio) / material.youngs_modulus;
  patch_compliance_ = 0.6 * share / load.pair.effective_modulus;
  widest_contact_ = std::min(1.1, HertzContact::most_given_back / (0.8 * share));
  const double m = reduced_mass(body_mass, partner.mass);
  prescribed_duration_ = hertz_duration(m, load.approach_speed, load.pair);
  // The mean of sin^1.5 over half a period; the impulse is that of an elastic rigid impact, 2 m v.
  const double mean = std::beta(1.25, 0.5) / std::numbers::pi;
  prescribed_peak_ = 2 * m * load.approach_speed / (prescribed_duration_ * mean);
}

double ContactLoad::evaluate(const Continuum& body, const Vec3& partner_displacement, double time, double time_step) {
  if (!attached_) return force_ = 0;
  const double indentation = patch_.indentation(body);
  const double partner = load_.approach_speed * time - partner_displacement.dot(load_.outward);
  double force = 0;
  if (model_ == LoadModel::contact) {
    const double approach = partner - indentation - gap_;
    force = contact_.load_through_patch(approach, patch_compliance_ / patch_.radius());
  } else if (const double middle = time + 0.5 * time_step; middle < prescribed_duration_) {
    force = prescribed_peak_ * std::pow(std::sin(std::numbers::pi * middle / prescribed_duration_), 1.5);
  }
  // Trapezoidal: a left-hand sum would create energy over every cycle of the contact.
  work_ += 0.5 * (force_ + force) * (indentation - indentation_);
  indentation_ = indentation;
  force_ = force;
  if (force > 0) {
    if (result_.first_time < 0) result_.first_time = time;
    result_.last_time = time + time_step;
    result_.peak_force = std::max(result_.peak_force, force);
    if (contact_.patch_radius() > widest_contact_ * patch_.radius()) widen_patch(body);
  }
  return force;
}

Vec3 ContactLoad::apply(double time_step, Continuum& body) {
  if (force_ <= 0 || !attached_) return Vec3::Zero();
  const double impulse = force_ * time_step;
  patch_.push(impulse, body);
  result_.impulse += impulse;
  return impulse * load_.outward;
}

void ContactLoad::widen_patch(const Continuum& body) {
  // Far enough that it does not come to that again at once.
  patch_ = LoadedPatch(body, load_.point, load_.outward, 1.1 / widest_contact_ * contact_.patch_radius());
  attached_ = patch_.drop_escaped(body);
  const double indentation = attached_ ? patch_.indentation(body) : 0;
  gap_ += indentation_ - indentation;
  indentation_ = indentation;
}

void ContactLoad::drop_escaped(const Continuum& body) {
  if (!attached_) return;
  const double before = patch_.indentation(body);
  attached_ = patch_.drop_escaped(body);
  if (!attached_) return;
  // The patch that remains stands elsewhere: neither the gap nor the work may notice.
  const double shift = patch_.indentation(body) - before;
  gap_ -= shift;
  indentation_ += shift;
}

}  // namespace sunder::mpm
