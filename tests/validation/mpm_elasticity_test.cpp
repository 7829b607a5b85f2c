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

Mat3 spin_matrix(const Vec3& w) {
  Mat3 m;
  m << 0, -w[2], w[1], w[2], 0, -w[0], -w[1], w[0], 0;
  return m;
}

/// A cube of side 1, eight particles a cell, somewhere off the grid's nodes.
fixture::FreeBody cube() {
  const fixture::Body body = fixture::block(Vec3::Constant(0.5), cell / 2);
  return {body.points, std::pow(cell / 2, 3), 1, cell, Vec3::Constant(1.37 * cell)};
}

// A1. APIC keeps momentum and angular momentum; the latter includes m h^2/4 axial(C). Fan (2024) 2.23 prints C_p
// (x_p - x_i), which loses 98 % of it in 50 steps, and starts from C = I.
TEST(Validation, A1_ApicRigidSpin) {
  fixture::FreeBody body = cube();
  const Vec3 w(0, 0, 1), drift(0.3, -0.2, 0.1);
  for (Particle& p : body.particles) {
    p.velocity = drift + w.cross(p.material_position);
    p.affine_velocity = spin_matrix(w);
  }
  const Vec3 momentum = body.momentum(), angular = body.angular_momentum();
  // The part of the affine velocities is not small change: m h^2/2 w of every particle.
  Vec3 without = Vec3::Zero();
  for (const Particle& p : body.particles) without += body.mass * p.position().cross(p.velocity);
  EXPECT_NEAR((angular - without)[2], 0.5 * cell * cell, 1e-12);
  for (int n = 0; n < 400; ++n) {
    body.step(0.01, fixture::no_stress);
    ASSERT_LT((body.momentum() - momentum).norm(), 1e-12 * momentum.norm());
    ASSERT_LT((body.angular_momentum() - angular).norm(), 1e-12 * angular.norm());
  }
}

// A2. Symmetric stress exerts no net force and no net torque, step by step. The printed sign of 2.24 makes it
// anti-elastic.
TEST(Validation, A2_MomentumUnderStress) {
  fixture::FreeBody body = cube();
  Material material = fixture::rubber();
  material.density = 1;
  material.youngs_modulus = 1;
  const double dt = 0.2 * cell / material.p_wave_speed();
  std::uint64_t n = 0;
  for (Particle& p : body.particles)
    for (int k = 0; k < 9; ++k) p.displacement_gradient(k / 3, k % 3) = 0.05 * (2 * random_unit(8, 8, n++) - 1);
  double strongest = 0;
  for (int step = 0; step < 200; ++step) {
    body.step(dt, fixture::elastic(material));
    for (const Particle& p : body.particles) strongest = std::max(strongest, p.velocity.norm());
    const double scale = strongest * body.mass * static_cast<double>(body.particles.size());
    ASSERT_LT(body.momentum().norm(), 1e-12 * scale);
    ASSERT_LT(body.angular_momentum().norm(), 1e-12 * scale);
  }
  // It has to move, and to stay tame: the elastic energy of 5 % strain.
  EXPECT_GT(strongest, 1e-3);
  EXPECT_LT(strongest, 0.1);
}

// A4. F' = (I + dt C) F with a rotation rate inflates by (1 + (w dt)^2) a step: J after one turn is exp(2 pi w dt).
TEST(Validation, A4_RigidRotationInflates) {
  fixture::FreeBody body = cube();
  const Vec3 w = 2 * Vec3(1, 2, -2).normalized() / 2;
  const double dt = 1e-3;
  const int steps = static_cast<int>(std::round(2 * pi / (w.norm() * dt)));
  // Nodal velocities of a rigid rotation about the particle, whatever they were.
  Particle p;
  p.material_position = Vec3(0.1, 0.2, 0.3);
  std::vector<Particle> one{p};
  Grid grid(Box(Vec3::Zero(), Vec3::Ones()), cell, 4, Vec3::Zero());
  const SlabOrder slabs = slab_order(one, grid);
  for (int n = 0; n < steps; ++n) {
    for (int i = 0; i < grid.size(0); ++i)
      for (int j = 0; j < grid.size(1); ++j)
        for (int k = 0; k < grid.size(2); ++k)
          grid.node(grid.index(i, j, k)).head<3>() =
              w.cross(Vec3(grid.origin() + cell * Vec3(i, j, k) - one[0].position()));
    grid_to_particle(grid, slabs, dt, one);
  }
  const double j = 1 + volume_change(one[0].displacement_gradient);
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
  load.approach_speed = 200;
  load.pair = {0.02, effective_modulus(1e6, 0.3, 210e9, 0.3)};
  const SolveResult r = fixture::run(body, material, {load}, {{1.0}});
  for (const ParticleState& p : r.particles) ASSERT_TRUE(p.displacement.allFinite() && p.velocity.allFinite());
  EXPECT_GT(r.crushed_resets, 0);
  EXPECT_LE(r.work, 1.01 * r.impact_energy);
}

}  // namespace
