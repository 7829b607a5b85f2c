#include "mpm/hertz_contact.h"

#include <cmath>
#include <numbers>

namespace sunder::mpm {

using std::numbers::pi;

double effective_modulus(double e1, double nu1, double e2, double nu2) {
  return 1 / ((1 - nu1 * nu1) / e1 + (1 - nu2 * nu2) / e2);
}

double hertz_duration(double m, double v, const ContactPair& pair) {
  return 2.868 * std::pow(m * m / (pair.effective_radius * pair.effective_modulus * pair.effective_modulus * v), 0.2);
}

double hertz_peak_force(double m, double v, const ContactPair& pair) {
  const double indentation =
      std::pow(15 * m * v * v / (16 * std::sqrt(pair.effective_radius) * pair.effective_modulus), 0.4);
  return 1.25 * m * v * v / indentation;
}

HertzContact::HertzContact(const ContactPair& pair) : pair_(pair) {
  const double r = pair.effective_radius, e = pair.effective_modulus;
  stiffness_ = 4.0 / 3 * e * std::sqrt(r);
  const double slope = 3 * pi * pair.contact_pressure / (4 * e);
  yield_indentation_ = r * slope * slope;
  yield_force_ = stiffness_ * std::pow(yield_indentation_, 1.5);
  unloading_radius_ = r;
}

double HertzContact::force(double d) const {
  if (d <= 0) return 0;
  if (d >= deepest_) {
    return d < yield_indentation_
               ? stiffness_ * d * std::sqrt(d)
               : yield_force_ + pi * pair_.contact_pressure * pair_.effective_radius * (d - yield_indentation_);
  }
  if (d <= residual_) return 0;
  const double elastic = d - residual_;
  return 4.0 / 3 * pair_.effective_modulus * std::sqrt(unloading_radius_) * elastic * std::sqrt(elastic);
}

double HertzContact::elastic_indentation(double f) const {
  return std::pow(3 * f / (4 * pair_.effective_modulus * std::sqrt(unloading_radius_)), 2.0 / 3);
}

double HertzContact::load(double d) {
  const double f = force(d);
  if (d < deepest_ || d <= 0) return f;
  deepest_ = d;
  patch_radius_ = std::sqrt(pair_.effective_radius * d);
  if (d < yield_indentation_) return f;
  unloading_radius_ = 4 * pair_.effective_modulus * patch_radius_ * patch_radius_ * patch_radius_ / (3 * f);
  residual_ = d - elastic_indentation(f);
  return f;
}

}  // namespace sunder::mpm
