#include "mpm/contact_load.h"

#include <numbers>

#include <gtest/gtest.h>

#include "tests/mpm/bodies.h"
#include "tests/mpm/free_body.h"

namespace {

using namespace sunder;
using namespace sunder::mpm;

constexpr double spacing = 0.004, h = 2 * spacing, ball = 0.01, speed = 5;

struct Case {
  fixture::Body body = fixture::plate(spacing, 0);
  Continuum plate{body.points, std::pow(spacing, 3), fixture::dust(2500),
                  fixture::continuum_settings(h, 1e-9, Vec3::Zero())};
  double mass = 2500 * body.volume;
  Partner partner{fixture::steel_ball_mass(ball)};
  Load load = fixture::steel_ball_on_glass({0, 0.01, 0}, Vec3::UnitY(), speed, ball);
  SolveSettings settings;

  ContactLoad contact() const { return ContactLoad(load, mass, partner, fixture::glass(), settings, plate); }

  template <class Displacement>
  void displace(const Displacement& displacement) {
    for (int id = 0; id < plate.size(); ++id) {
      if (plate.escaped(id)) continue;
      PointState p = plate.point(id);
      p.displacement = displacement(p.material_position);
      plate.set_point(id, p);
    }
  }
};

TEST(ReducedMass, OfABodyAndItsPartner) {
  EXPECT_DOUBLE_EQ(reduced_mass(2, 2), 1);
  EXPECT_DOUBLE_EQ(reduced_mass(3, 6), 2);
  EXPECT_EQ(reduced_mass(3, std::numeric_limits<double>::infinity()), 3);
}

TEST(ContactLoad, PushesOnlyWhileThePartnerIndents) {
  Case f;
  ContactLoad contact = f.contact();
  EXPECT_EQ(contact.evaluate(f.plate, Vec3::Zero(), 0, 1e-6), 0);
  EXPECT_EQ(contact.result().first_time, -1);
  const double force = contact.evaluate(f.plate, Vec3::Zero(), 2e-6, 1e-6);
  EXPECT_GT(force, 0);
  EXPECT_EQ(contact.result().first_time, 2e-6);
  EXPECT_EQ(contact.result().peak_force, force);
  // The partner has been thrown back along +outward further than it came.
  EXPECT_EQ(contact.evaluate(f.plate, 2 * speed * 3e-6 * Vec3::UnitY(), 3e-6, 1e-6), 0);
  // The surface has given way faster than the partner follows.
  f.displace([&](const Vec3&) { return Vec3(0, -1e-3, 0); });
  EXPECT_EQ(contact.evaluate(f.plate, Vec3::Zero(), 4e-6, 1e-6), 0);
}

TEST(ContactLoad, TheForceIsAtLeastTheHertzForceOfTheApproach) {
  // The patch of the solve gives way by itself, so the law is asked for a little more indentation than the approach.
  Case f;
  ContactLoad contact = f.contact();
  const double time = 2e-6, force = contact.evaluate(f.plate, Vec3::Zero(), time, 1e-6);
  const double hertz = HertzContact(f.load.pair).force(speed * time);
  EXPECT_GE(force, hertz);
  EXPECT_LT(force, 2 * hertz);
}

TEST(ContactLoad, ImpulseIsForceTimesTimeAndReachesTheBodyWhole) {
  Case f;
  ContactLoad contact = f.contact();
  const double dt = 1e-6, force = contact.evaluate(f.plate, Vec3::Zero(), 5e-6, dt);
  f.plate.advance(0);
  const Vec3 on_partner = contact.apply(dt, f.plate);
  f.plate.update_grid();
  const Vec3 on_body = f.plate.momentum(f.plate.finish());
  EXPECT_LT((on_partner - Vec3(0, force * dt, 0)).norm(), 1e-15 * force);
  EXPECT_LT((on_body + on_partner).norm(), 1e-12 * on_partner.norm());
  EXPECT_DOUBLE_EQ(contact.result().impulse, force * dt);
}

TEST(ContactLoad, TheLawSeesTheApproachAndWhatThePatchGaveWay) {
  // d = approach + min(c F(d), 0.6 d): the force must solve it at every radius of the contact, also where the patch is
  // no wider than the contact and the fixed point of the equation repels.
  for (double radius : {0.001, 0.01, 0.1})
    for (double approach : {1e-6, 3e-5, 1e-4, 3e-4}) {
      Case f;
      f.load.pair.effective_radius = radius;
      f.load.pair.contact_pressure = std::numeric_limits<double>::infinity();
      ContactLoad contact = f.contact();
      const double force = contact.evaluate(f.plate, Vec3::Zero(), approach / speed, 1e-9);
      const double e = f.load.pair.effective_modulus, chi = e * (1 - 0.22 * 0.22) / 70e9;
      const double d = std::pow(force / (4.0 / 3 * e * std::sqrt(radius)), 2.0 / 3);
      const double give = std::min(0.6 * chi / e / (1.5 * h) * force, 0.6 * d);
      EXPECT_NEAR(d, approach + give, 1e-9 * d) << radius << " " << approach;
    }
}

// Problem A8: the integral of the prescribed force is the impulse of an elastic rigid impact.
TEST(ContactLoad, PrescribedForceDeliversTwiceTheMomentumWithTheHertzPeak) {
  Case f;
  f.settings.load = LoadModel::prescribed;
  ContactLoad contact = f.contact();
  const double m = reduced_mass(f.mass, f.partner.mass), duration = hertz_duration(m, speed, f.load.pair);
  const double dt = duration / 1000;
  double sum = 0;
  for (int n = 0; n < 1200; ++n) sum += dt * contact.evaluate(f.plate, Vec3::Zero(), n * dt, dt);
  // Midpoint rule on a force that starts with t^1.5: the error is of order (dt/t_c)^2.
  EXPECT_NEAR(sum, 2 * m * speed, 1e-5 * sum);
  // 1.84 of Hertz' own time course against the fitted sin^1.5: 2 % apart.
  EXPECT_NEAR(contact.result().peak_force, hertz_peak_force(m, speed, f.load.pair), 0.05 * contact.result().peak_force);
  EXPECT_NEAR(contact.result().last_time, duration, 1.01 * dt);
}

TEST(ContactLoad, WorkIsTheIntegralOfForceOverIndentation) {
  Case f;
  ContactLoad contact = f.contact();
  double work = 0, force = 0, indentation = 0;
  for (int n = 1; n <= 20; ++n) {
    const double give = 2e-7 * n * n;
    f.displace([&](const Vec3&) { return Vec3(0, -give, 0); });
    const double now = contact.evaluate(f.plate, Vec3::Zero(), n * 2e-6, 2e-6);
    work += 0.5 * (force + now) * (give - indentation);
    force = now;
    indentation = give;
  }
  EXPECT_GT(work, 0);
  EXPECT_NEAR(contact.work(), work, 1e-12 * work);
}

TEST(ContactLoad, ForgetsNothingElseWhenParticlesEscapeElsewhere) {
  Case f;
  ContactLoad contact = f.contact();
  ASSERT_GT(contact.evaluate(f.plate, Vec3::Zero(), 1e-5, 1e-9), 0);
  ContactLoad untouched = contact;
  const auto corner = [](const Vec3& x) { return x[0] > 0.04 && x[2] > 0.04; };
  f.displace([&](const Vec3& x) { return Vec3(0, corner(x) ? 10 : -5e-6, 0); });
  f.plate.follow(Box(Vec3::Constant(-1), Vec3::Constant(1)));
  f.plate.advance(0);
  ASSERT_GT(f.plate.escapes(), 0);
  contact.drop_escaped(f.plate);
  EXPECT_EQ(contact.evaluate(f.plate, Vec3::Zero(), 1e-5, 1e-9), untouched.evaluate(f.plate, Vec3::Zero(), 1e-5, 1e-9));
  EXPECT_EQ(contact.work(), untouched.work());
}

TEST(ContactLoad, ForgetsWhatEscapedWithoutAJump) {
  Case f;
  ContactLoad contact = f.contact();
  f.displace([](const Vec3& x) { return Vec3(0, x[0] > 0 ? 1e-6 : -1e-6, 0); });
  const double before = contact.evaluate(f.plate, Vec3::Zero(), 1e-5, 1e-9);
  ASSERT_GT(before, 0);
  f.plate.follow(Box(Vec3(-1, -1, -1), Vec3(0, 1, 1)));
  f.plate.advance(0);
  ASSERT_GT(f.plate.escapes(), 0);
  contact.drop_escaped(f.plate);
  EXPECT_NEAR(contact.evaluate(f.plate, Vec3::Zero(), 1e-5, 1e-9), before, 1e-6 * before);
  f.displace([](const Vec3&) { return Vec3(0, 100, 0); });
  f.plate.advance(0);
  contact.drop_escaped(f.plate);
  EXPECT_EQ(contact.evaluate(f.plate, Vec3::Zero(), 1e-5, 1e-9), 0);
  EXPECT_EQ(contact.apply(1e-9, f.plate), Vec3(Vec3::Zero()));
}

}  // namespace
