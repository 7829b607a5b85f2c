#include "mpm/hertz_contact.h"

#include <algorithm>
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

// The indentation d = approach + min(c F(d), 0.6 d_elastic(F(d))). Where the first is the smaller one it grows by less
// than 1.5 * 0.6 d, the second by at most 0.6 d, and d_elastic <= d: the one root lies in [approach, 2.5 approach], and
// is closed in on from both sides.
double HertzContact::load_through_patch(double approach, double patch_compliance) {
  if (approach <= 0) return 0;
  const auto excess = [&](double d) {
    const double f = force(d);
    return approach + std::min(patch_compliance * f, most_given_back * elastic_indentation(f)) - d;
  };
  double low = approach, high = approach / (1 - most_given_back), at_low = excess(low), at_high = excess(high);
  for (int turn = 0; turn < 60 && high - low > 1e-13 * high && at_low > 0; ++turn) {
    double middle = (low * at_high - high * at_low) / (at_high - at_low);
    if (!(middle > low && middle < high)) middle = 0.5 * (low + high);
    const double at = excess(middle);
    // Illinois: an end that stays twice counts half.
    if (at > 0) {
      low = middle;
      at_low = at;
      at_high *= 0.5;
    } else {
      high = middle;
      at_high = at;
      at_low *= 0.5;
    }
  }
  return load(low);
}

}  // namespace sunder::mpm
