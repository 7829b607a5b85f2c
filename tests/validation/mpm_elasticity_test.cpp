/// Problems A of the catalogue: elasticity, momentum and impact. One test per problem, named after it.
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "mpm/contact_load.h"
#include "tests/mpm/bodies.h"
#include "tests/mpm/free_body.h"

namespace {

using namespace sunder;
using namespace sunder::mpm;
using std::numbers::pi;

constexpr double cell = 0.125;

/// A cube of side 1, eight particles a cell, somewhere off the grid's nodes.
fixture::FreeBody cube(const Material& material, double time_step, Spline spline) {
  const fixture::Body body = fixture::block(Vec3::Constant(0.5), cell / 2);
  return {body.points, std::pow(cell / 2, 3), material,
          fixture::continuum_settings(cell, time_step, Vec3::Constant(1.37 * cell), spline)};
}

// A1. APIC keeps momentum and angular momentum; the latter includes m moment h^2 axial(C), moment 1/4 or 1/3. Fan
// (2024) 2.23 prints C_p (x_p - x_i), which loses 98 % of it in 50 steps, and starts from C = I.
TEST(Validation, A1_ApicRigidSpin) {
  for (Spline spline : {Spline::quadratic, Spline::cubic}) {
    fixture::FreeBody free = cube(fixture::dust(1), 0.01, spline);
    const Vec3 w(0, 0, 1), drift(0.3, -0.2, 0.1);
    for (int id = 0; id < free.body.size(); ++id)
      free.motion[static_cast<std::size_t>(id)] = {drift + w.cross(free.body.material_position(id)),
                                                   fixture::spin_matrix(w)};
    const Vec3 momentum = free.body.momentum(free.motion), angular = free.body.angular_momentum(free.motion);
    // The part of the affine velocities is not small change: m 2 moment h^2 w of every particle.
    Vec3 without = Vec3::Zero();
    for (int id = 0; id < free.body.size(); ++id)
      without += free.body.particle_mass() *
                 free.body.material_position(id).cross(free.motion[static_cast<std::size_t>(id)].velocity);
    EXPECT_NEAR((angular - without)[2], 2 * spline_moment(spline) * cell * cell, 1e-12);
    for (int n = 0; n < 400; ++n) {
      free.step();
      ASSERT_LT((free.body.momentum(free.motion) - momentum).norm(), 1e-12 * momentum.norm());
      ASSERT_LT((free.body.angular_momentum(free.motion) - angular).norm(), 1e-12 * angular.norm());
    }
  }
}

// A2. Symmetric stress exerts no net force and no net torque, step by step. The printed sign of 2.24 makes it
// anti-elastic.
TEST(Validation, A2_MomentumUnderStress) {
  Material material = fixture::rubber();
  material.density = 1;
  material.youngs_modulus = 1;
  for (Spline spline : {Spline::quadratic, Spline::cubic}) {
    fixture::FreeBody free = cube(material, 0.2 * cell / material.p_wave_speed(), spline);
    std::uint64_t n = 0;
    for (int id = 0; id < free.body.size(); ++id) {
      PointState p = free.body.point(id);
      for (int k = 0; k < 9; ++k) p.displacement_gradient(k / 3, k % 3) = 0.05 * (2 * random_unit(8, 8, n++) - 1);
      free.body.set_point(id, p);
    }
    double strongest = 0;
    for (int step = 0; step < 200; ++step) {
      free.step();
      for (const Motion& m : free.motion) strongest = std::max(strongest, m.velocity.norm());
      const double scale = strongest * free.body.particle_mass() * free.body.size();
      ASSERT_LT(free.body.momentum(free.motion).norm(), 1e-12 * scale);
      ASSERT_LT(free.body.angular_momentum(free.motion).norm(), 1e-12 * scale);
    }
    // It has to move, and to stay tame: the elastic energy of 5 % strain.
    EXPECT_GT(strongest, 1e-3);
    EXPECT_LT(strongest, 0.1);
  }
}

// A4. F' = (I + dt C) F with a rotation rate inflates by (1 + (w dt)^2) a step: J after one turn is exp(2 pi w dt).
TEST(Validation, A4_RigidRotationInflates) {
  const Vec3 w = 2 * Vec3(1, 2, -2).normalized() / 2;
  const double dt = 1e-3;
  const int steps = static_cast<int>(std::round(2 * pi / (w.norm() * dt)));
  fixture::FreeBody free({Vec3(0.1, 0.2, 0.3)}, 1e-3, fixture::dust(1),
                         fixture::continuum_settings(cell, dt, Vec3::Zero()));
  for (int n = 0; n < steps; ++n) {
    free.motion = {{Vec3::Zero(), fixture::spin_matrix(w)}};
    free.step();
  }
  const double j = 1 + volume_change(free.body.displacement_gradient(0));
  EXPECT_NEAR(j, std::pow(1 + dt * dt * w.squaredNorm(), steps), 1e-11);
  EXPECT_NEAR(j, std::exp(2 * pi * w.norm() * dt), 1e-5);
}

// A8, formulas: two spheres of rubber and a steel ball on a steel wall.
TEST(Validation, A8_HertzFormulas) {
  const double mass = 1000 * 4.0 / 3 * pi * std::pow(0.05, 3);
  const ContactPair spheres{0.025, effective_modulus(1e6, 0.3, 1e6, 0.3)};
  const double m = reduced_mass(mass, mass), v = 2;
  EXPECT_NEAR(hertz_duration(m, v, spheres), 15.5e-3, 0.05e-3);
  EXPECT_NEAR(std::pow(15 * m * v * v / (16 * std::sqrt(0.025) * spheres.effective_modulus), 0.4), 10.5e-3, 0.05e-3);
  EXPECT_NEAR(hertz_peak_force(m, v, spheres) / (2 * m * v / hertz_duration(m, v, spheres)), 1.84, 0.01);

  const double ball = 7800 * 4.0 / 3 * pi * std::pow(0.01, 3);
  const ContactPair steel{0.01, effective_modulus(210e9, 0.3, 210e9, 0.3)};
  EXPECT_NEAR(hertz_duration(ball, 1, steel), 68.9e-6, 0.01 * 68.9e-6);
  EXPECT_NEAR(hertz_peak_force(ball, 1, steel), 1744, 0.01 * 1744);

  // t_c goes with v^-1/5 and with the size of the system.
  EXPECT_NEAR(std::log(hertz_duration(m, 20, spheres) / hertz_duration(m, 2, spheres)) / std::log(10.0), -0.2, 1e-12);
  const ContactPair larger{0.25, spheres.effective_modulus};
  EXPECT_NEAR(hertz_duration(1000 * m, v, larger) / hertz_duration(m, v, spheres), 10, 1e-11);
  EXPECT_NEAR(impact_duration(m, v, spheres) / hertz_duration(m, v, spheres), 1, 1e-3);
}

// A8, impact of two rubber spheres: one of particles, the other a mass behind the contact law.
TEST(Validation, A8_HertzImpactOfTwoSpheres) {
  const fixture::Body body = fixture::sphere(0.0056, 0);
  const double mass = 1000 * body.volume, speed = 0.5;
  Load load;
  load.point = {0, 0.05, 0};
  load.approach_speed = speed;
  load.pair = {0.025, effective_modulus(1e6, 0.3, 1e6, 0.3)};
  const SolveResult r = fixture::run(body, fixture::rubber(), {load}, {{mass}});
  const double m = reduced_mass(mass, mass), duration = r.loads[0].last_time - r.loads[0].first_time;
  std::printf("duration %.3f, peak force %.3f of Hertz, restitution %.3f\n",
              duration / hertz_duration(m, speed, load.pair),
              r.loads[0].peak_force / hertz_peak_force(m, speed, load.pair), r.loads[0].impulse / (m * speed) - 1);
  EXPECT_NEAR(duration / hertz_duration(m, speed, load.pair), 1, 0.15);
  EXPECT_NEAR(r.loads[0].peak_force / hertz_peak_force(m, speed, load.pair), 1, 0.15);
  EXPECT_GT(r.loads[0].impulse / (m * speed) - 1, 0.85);
  EXPECT_LE(r.loads[0].impulse / (m * speed) - 1, 1.01);
}

// A11. No stretch, however large or inverted, makes the solver return something that is not a number.
TEST(Validation, A11_CrushingImpactStaysFinite) {
  const fixture::Body body = fixture::block(Vec3::Constant(0.05), 0.01);
  Material material = fixture::rubber();
  material.density = 10;
  Load load;
  load.point = {0, 0.05, 0};
  load.approach_speed = 400;
  load.pair = {0.02, effective_modulus(1e6, 0.3, 210e9, 0.3)};
  const SolveResult r = fixture::run(body, material, {load}, {{1.0}});
  for (const ParticleState& p : r.particles) ASSERT_TRUE(p.displacement.allFinite() && p.velocity.allFinite());
  EXPECT_GT(r.crushed_resets, 0);
  EXPECT_LE(r.work, 1.01 * r.impact_energy);
}

}  // namespace
