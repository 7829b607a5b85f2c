#include "mpm/hertz_contact.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "mpm/contact_load.h"

namespace {

using namespace sunder::mpm;
using std::numbers::pi;

constexpr double infinity = std::numeric_limits<double>::infinity();
const ContactPair elastic{0.01, 115e9, infinity};
const ContactPair crushing{0.01, 40e9, 500e6};

/// Impact of one degree of freedom, velocity Verlet; returns the speed of the rebound.
double rebound_speed(const ContactPair& pair, double mass, double speed) {
  HertzContact contact(pair);
  const double dt = hertz_duration(mass, speed, pair) / 20000;
  double d = 0, v = speed, force = 0;
  for (int n = 0; n < 400000 && (v > 0 || force > 0); ++n) {
    v -= 0.5 * dt * force / mass;
    d += dt * v;
    force = contact.load(d);
    v -= 0.5 * dt * force / mass;
  }
  return -v;
}

TEST(HertzContact, LoadsLikeHertzBelowCrushing) {
  HertzContact contact(elastic);
  const double d = 1e-5;
  EXPECT_NEAR(contact.load(d), 4.0 / 3 * 115e9 * std::sqrt(0.01) * std::pow(d, 1.5), 1e-9);
  EXPECT_NEAR(contact.patch_radius(), std::sqrt(0.01 * d), 1e-15);
  EXPECT_NEAR(contact.elastic_indentation(contact.force(d)), d, 1e-12 * d);
}

TEST(HertzContact, NeverPulls) {
  HertzContact contact(crushing);
  EXPECT_EQ(contact.load(-1e-3), 0);
  contact.load(1e-3);
  for (double d = -1e-3; d < 1e-3; d += 1e-6) EXPECT_GE(contact.force(d), 0);
}

TEST(HertzContact, IsContinuousWhereCrushingStarts) {
  const HertzContact contact(crushing);
  const double slope = 3 * pi * crushing.contact_pressure / (4 * crushing.effective_modulus);
  const double yield = crushing.effective_radius * slope * slope;
  // Hertz grows with d^1.5, so a relative step s changes the force by 1.5 s.
  EXPECT_NEAR(contact.force(yield * (1 + 1e-12)) / contact.force(yield * (1 - 1e-12)), 1, 1e-11);
}

TEST(HertzContact, TheMeanPressureStaysAtTheCrushingPressure) {
  for (double d : {1e-4, 5e-4, 2e-3}) {
    HertzContact contact(crushing);
    const double force = contact.load(d), a = contact.patch_radius();
    EXPECT_NEAR(force / (pi * a * a), crushing.contact_pressure, 1e-9 * crushing.contact_pressure);
  }
}

TEST(HertzContact, UnloadingStartsAtTheForceReachedAndKeepsADent) {
  HertzContact contact(crushing);
  const double deepest = 5e-4, force = contact.load(deepest);
  EXPECT_NEAR(contact.force(deepest * (1 - 1e-12)), force, 1e-6 * force);
  EXPECT_NEAR(contact.force(deepest), force, 1e-12 * force);
  EXPECT_LT(contact.force(0.999 * deepest), force);
  EXPECT_EQ(contact.force(0.5 * deepest), 0);
  // Loading again follows the way back, then the crushing line.
  EXPECT_NEAR(contact.load(deepest), force, 1e-12 * force);
  EXPECT_GT(contact.load(1.1 * deepest), force);
}

TEST(HertzContact, ReboundIsElasticWithoutCrushingAndSlowerWithIt) {
  EXPECT_NEAR(rebound_speed(elastic, 0.03, 2), 2, 2e-3);
  double before = 1;
  for (double speed : {2.0, 8.0, 32.0}) {
    const double restitution = rebound_speed(crushing, 0.03, speed) / speed;
    EXPECT_GT(restitution, 0.1);
    EXPECT_LT(restitution, before);
    before = restitution;
  }
}

// Where a patch gave way by more than two thirds of the indentation the equation had a fold: a force that doubled from
// one step to the next.
RC_GTEST_PROP(HertzContact, TheForceThroughAPatchIsContinuous, ()) {
  const auto log_real = [](double low, double high) {
    return low * std::pow(high / low, *rc::gen::inRange(0, 1001) * 1e-3);
  };
  const ContactPair pair{log_real(1e-3, 1), log_real(1e9, 1e11), log_real(1e7, 1e12)};
  const double most = log_real(1e-5, 1e-2) * pair.effective_radius;
  // From a patch that is wide to one that is narrow beside the contact.
  const double compliance =
      log_real(0.03, 3) * 0.6 / (pair.effective_modulus * std::sqrt(pair.effective_radius * most));
  // Relative, of a step of a thousandth: forces grow with d^1.5, and d by at most ten times the approach.
  constexpr double step = 1e-3, bound = 1.5 * 10 * step;
  HertzContact contact(pair);
  double approach = 0.01 * most, force = contact.load_through_patch(approach, compliance);
  for (; approach < most; approach *= 1 + step) {
    const double next = contact.load_through_patch(approach, compliance);
    RC_ASSERT(next >= force * (1 - 1e-9));
    RC_ASSERT(next <= force * (1 + 1.01 * bound));
    force = next;
  }
  const double largest = force, give = contact.elastic_indentation(force);
  for (approach /= 1 + step; force > 0; approach -= step * give) {
    const double next = contact.load_through_patch(approach, compliance);
    RC_ASSERT(next <= force + 1e-9 * largest);
    RC_ASSERT(force - next <= 1.01 * bound * largest);
    force = next;
  }
}

TEST(ImpactDuration, IsTheHertzDurationWhenElastic) {
  // 4000 steps of first order over the contact, and the constant 2.868 has four digits.
  for (double speed : {0.1, 1.0, 10.0})
    EXPECT_NEAR(impact_duration(0.03, speed, elastic) / hertz_duration(0.03, speed, elastic), 1, 1e-3);
}

TEST(ImpactDuration, SoftContactTakesAboutHalfAPeriodOfTheCrushingSpring) {
  // Deep in crushing F = pi p R d on the way in: a quarter of the period 2 pi sqrt(m / (pi p R)); the way out is short.
  const double mass = 0.1, speed = 40;
  const ContactPair pair{0.02, 50e9, 30e6};
  const double quarter = 0.5 * pi * std::sqrt(mass / (pi * pair.contact_pressure * pair.effective_radius));
  const double duration = impact_duration(mass, speed, pair);
  EXPECT_GT(duration, 0.99 * quarter);
  EXPECT_LT(duration, 1.2 * quarter);
}

}  // namespace
