#include "mpm/continuum.h"

#include <algorithm>

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "core/error.h"
#include "mpm/rankine.h"
#include "tests/mpm/free_body.h"
#include "tests/mpm/reference_step.h"

namespace {

using namespace sunder;
using namespace sunder::mpm;

constexpr double cell = 0.125, time_step = 1e-4;
constexpr double infinity = std::numeric_limits<double>::infinity();

struct Variant {
  Spline spline;
  InstructionSet instructions;
};

std::vector<Variant> variants() {
  std::vector<Variant> all;
  for (Spline spline : {Spline::quadratic, Spline::cubic})
    for (InstructionSet set : {InstructionSet::portable, InstructionSet::avx2, InstructionSet::avx512})
      if (has(set)) all.push_back({spline, set});
  return all;
}

std::string name(const ::testing::TestParamInfo<Variant>& info) {
  std::string text = info.param.spline == Spline::quadratic ? "quadratic" : "cubic";
  for (char c : std::string(name_of(info.param.instructions)))
    if (c != '-') text += c;
  return text;
}

/// A block in random motion and deformation; two thirds of its points are damaged or about to be.
fixture::FreeBody random_block(const Variant& variant, double strain = 0.05, double spin = 0) {
  const fixture::Body block = fixture::block({0.5, 0.3, 0.4}, cell / 2, 0.2);
  auto settings = fixture::continuum_settings(cell, time_step, Vec3::Constant(0.0371), variant.spline);
  settings.instructions = variant.instructions;
  settings.viscosity = 2;
  const Material material = fixture::rubber();
  fixture::FreeBody free(block.points, std::pow(cell / 2, 3), material, settings);
  std::uint64_t n = 0;
  const auto random = [&] { return 2 * random_unit(5, 1, n++) - 1; };
  for (int id = 0; id < free.body.size(); ++id) {
    PointState p = free.body.point(id);
    Motion& m = free.motion[static_cast<std::size_t>(id)];
    m.velocity = Vec3(random(), random(), random()) + spin * Vec3::UnitZ().cross(p.material_position);
    for (int k = 0; k < 9; ++k) {
      p.displacement_gradient(k / 3, k % 3) = strain * random();
      m.affine_velocity(k / 3, k % 3) = 3 * random();
    }
    if (id % 3 > 0) p.strength = p.threshold = 0.3 * strain * material.youngs_modulus;
    p.softening_slope = 0.4;
    if (id % 3 == 2) p.damage = 0.6 * random_unit(5, 2, static_cast<std::uint64_t>(id));
    free.body.set_point(id, p);
  }
  return free;
}

class Step : public ::testing::TestWithParam<Variant> {};
INSTANTIATE_TEST_SUITE_P(Variants, Step, ::testing::ValuesIn(variants()), name);

TEST_P(Step, IsThePlainReferenceStep) {
  // Small and large strains: the logarithm has a branch for each.
  for (double strain : {0.004, 0.2}) {
    fixture::FreeBody free = random_block(GetParam(), strain, 1);
    std::vector<fixture::ReferencePoint> expected;
    for (int id = 0; id < free.body.size(); ++id)
      expected.push_back({free.body.point(id), free.motion[static_cast<std::size_t>(id)]});
    const Vec3 origin = Vec3::Constant(0.0371 - 8 * cell);
    fixture::ReferenceStep reference(fixture::rubber(), std::pow(cell / 2, 3), cell, time_step, 2, origin, {24, 24, 24},
                                     GetParam().spline);
    reference(expected);
    free.step();
    double speed = 0, gradient = 0, damaged = 0, dissipated = 0;
    for (const auto& p : expected) {
      speed = std::max(speed, p.motion.velocity.norm());
      gradient = std::max(gradient, p.motion.affine_velocity.norm());
      damaged += p.state.damage > 0;
      dissipated = std::max(dissipated, p.state.dissipated);
    }
    ASSERT_GT(damaged, 0.3 * free.body.size());
    for (int id = 0; id < free.body.size(); ++id) {
      const auto& e = expected[static_cast<std::size_t>(id)];
      const PointState p = free.body.point(id);
      const Motion& m = free.motion[static_cast<std::size_t>(id)];
      ASSERT_LT((m.velocity - e.motion.velocity).norm(), 1e-12 * speed) << id;
      ASSERT_LT((m.affine_velocity - e.motion.affine_velocity).norm(), 1e-12 * gradient) << id;
      ASSERT_LT((p.displacement_gradient - e.state.displacement_gradient).norm(), 1e-12 * strain) << id;
      ASSERT_LT((p.displacement - e.state.displacement).norm(), 1e-12 * speed * time_step) << id;
      ASSERT_NEAR(p.damage, e.state.damage, 1e-12) << id;
      ASSERT_NEAR(p.dissipated, e.state.dissipated, 1e-12 * dissipated) << id;
      if (p.strength < infinity) {
        ASSERT_NEAR(p.threshold, e.state.threshold, 1e-12 * p.threshold) << id;
      }
    }
  }
}

TEST_P(Step, FusedIsUnfused) {
  fixture::FreeBody unfused = random_block(GetParam()), fused = random_block(GetParam());
  constexpr int steps = 6;
  for (int n = 0; n < steps; ++n) unfused.step();
  fused.body.start(fused.motion);
  fused.body.update_grid();
  for (int n = 1; n < steps; ++n) {
    fused.body.advance(n * time_step);
    fused.body.update_grid();
  }
  fused.motion = fused.body.finish();
  // Bits differ: the compiler contracts other sums where motion is stored in between.
  double speed = 0;
  for (const Motion& m : unfused.motion) speed = std::max(speed, m.velocity.norm());
  for (int id = 0; id < fused.body.size(); ++id) {
    const std::size_t n = static_cast<std::size_t>(id);
    ASSERT_LT((fused.motion[n].velocity - unfused.motion[n].velocity).norm(), 1e-12 * speed);
    ASSERT_LT((fused.body.displacement_gradient(id) - unfused.body.displacement_gradient(id)).norm(), 1e-12);
    ASSERT_NEAR(fused.body.point(id).damage, unfused.body.point(id).damage, 1e-12);
  }
}

// Problem A3: linear patch test.
TEST_P(Step, CarriesALinearVelocityFieldThroughTheGrid) {
  fixture::FreeBody free = random_block(GetParam(), 0);
  Mat3 g;
  g << 0.3, -1.2, 0.4, 2, 0.1, -0.7, 0.5, 0.9, -0.4;
  const Vec3 drift(1, 2, 3);
  auto settings = fixture::continuum_settings(cell, time_step, Vec3::Constant(0.0371), GetParam().spline);
  settings.instructions = GetParam().instructions;
  std::vector<Vec3> points;
  for (int id = 0; id < free.body.size(); ++id) points.push_back(free.body.material_position(id));
  fixture::FreeBody linear(points, 1e-4, fixture::dust(1000), settings);
  for (std::size_t n = 0; n < points.size(); ++n) linear.motion[n] = {g * points[n] + drift, g};
  linear.step();
  for (std::size_t n = 0; n < points.size(); ++n) {
    const Vec3 v = g * points[n] + drift;
    EXPECT_LT((linear.motion[n].velocity - v).norm(), 1e-12);
    EXPECT_LT((linear.motion[n].affine_velocity - g).norm(), 1e-12);
    EXPECT_LT((linear.body.displacement_gradient(static_cast<int>(n)) - time_step * g).norm(), 1e-15);
    EXPECT_LT((linear.body.displacement(static_cast<int>(n)) - time_step * v).norm(), 1e-15);
  }
}

TEST_P(Step, BitsDoNotDependOnTheNumberOfThreads) {
  const auto after = [&](std::size_t threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    fixture::FreeBody free = random_block(GetParam(), 0.05, 40);
    free.body.start(free.motion);
    for (int n = 0; n < 40; ++n) {
      free.body.update_grid();
      free.body.advance(n * time_step);
    }
    return free;
  };
  const auto one = after(1), two = after(2), four = after(4);
  double damaged = 0;
  for (int id = 0; id < one.body.size(); ++id) {
    const PointState p = one.body.point(id);
    for (const auto* other : {&two, &four}) {
      ASSERT_EQ(p.displacement, other->body.displacement(id));
      ASSERT_EQ(p.displacement_gradient, other->body.displacement_gradient(id));
      ASSERT_EQ(p.damage, other->body.point(id).damage);
    }
    damaged += p.damage >= failed_damage;
  }
  EXPECT_GT(damaged, 0);
  EXPECT_EQ(one.body.viscous_work(), two.body.viscous_work());
}

TEST(InstructionSets, Avx2AndAvx512GiveTheSameBits) {
  if (!has(InstructionSet::avx512)) GTEST_SKIP() << "this machine has no AVX-512";
  for (Spline spline : {Spline::quadratic, Spline::cubic}) {
    const auto after = [&](InstructionSet set) {
      fixture::FreeBody free = random_block({spline, set}, 0.05, 40);
      free.body.start(free.motion);
      for (int n = 0; n < 40; ++n) {
        free.body.update_grid();
        free.body.advance(n * time_step);
      }
      return free;
    };
    const auto narrow = after(InstructionSet::avx2), wide = after(InstructionSet::avx512);
    for (int id = 0; id < narrow.body.size(); ++id) {
      ASSERT_EQ(narrow.body.displacement(id), wide.body.displacement(id));
      ASSERT_EQ(narrow.body.displacement_gradient(id), wide.body.displacement_gradient(id));
      ASSERT_EQ(narrow.body.point(id).damage, wide.body.point(id).damage);
    }
  }
}

/// A cloud without stress whose points fly apart: nearly all leave their blocks.
struct Cloud {
  explicit Cloud(const Variant& variant, double speed) {
    const fixture::Body block = fixture::block(Vec3::Constant(0.5), cell / 2, 0.3);
    auto settings = fixture::continuum_settings(cell, 0.01, Vec3::Constant(0.0371), variant.spline);
    settings.instructions = variant.instructions;
    free.emplace(block.points, std::pow(cell / 2, 3), fixture::dust(1000), settings);
    for (std::size_t n = 0; n < block.points.size(); ++n) {
      const auto random = [&](std::uint64_t k) { return 2 * random_unit(9, k, n) - 1; };
      free->motion[n].velocity = speed * (block.points[n] + 0.3 * Vec3(random(0), random(1), random(2)));
    }
  }
  std::optional<fixture::FreeBody> free;
};

TEST_P(Step, StraysKeepTheirMomentum) {
  // Straight through the fused step, so that strays come, go and are sorted.
  Cloud cloud(GetParam(), 3);
  fixture::FreeBody& free = *cloud.free;
  const Vec3 momentum = free.body.momentum(free.motion), angular = free.body.angular_momentum(free.motion);
  free.body.start(free.motion);
  free.body.update_grid();
  for (int n = 1; n < 60; ++n) {
    free.body.advance(n * 0.01);
    free.body.update_grid();
  }
  free.motion = free.body.finish();
  double farthest = 0;
  for (int id = 0; id < free.body.size(); ++id) farthest = std::max(farthest, free.body.displacement(id).norm());
  EXPECT_GT(farthest, 4 * cell);
  const double scale = free.body.particle_mass() * free.body.size();
  EXPECT_LT((free.body.momentum(free.motion) - momentum).norm(), 1e-12 * scale);
  EXPECT_LT((free.body.angular_momentum(free.motion) - angular).norm(), 1e-12 * scale);
}

TEST(Continuum, WhatFliesOutOfTheFollowedBoxKeepsItsVelocity) {
  Cloud cloud({Spline::quadratic, best_instruction_set()}, 3);
  fixture::FreeBody& free = *cloud.free;
  free.body.follow(Box(Vec3::Constant(-1), Vec3::Constant(1)));
  const Vec3 momentum = free.body.momentum(free.motion);
  free.body.start(free.motion);
  free.body.update_grid();
  for (int n = 1; n < 120; ++n) {
    free.body.advance(n * 0.01);
    free.body.update_grid();
  }
  free.motion = free.body.finish();
  EXPECT_GT(free.body.escapes(), 100);
  long escaped = 0;
  for (int id = 0; id < free.body.size(); ++id) {
    if (!free.body.escaped(id)) continue;
    ++escaped;
    EXPECT_EQ(free.body.point(id).damage, 1);
    EXPECT_GE(free.body.point(id).damage_time, 0);
    EXPECT_GT((free.body.material_position(id) + free.body.displacement(id)).cwiseAbs().maxCoeff(), 1);
  }
  EXPECT_EQ(escaped, free.body.escapes());
  // A point that leaves takes the velocity of the grid with it, not the affine part.
  EXPECT_LT((free.body.momentum(free.motion) - momentum).norm(), 1e-2 * free.body.particle_mass() * free.body.size());
}

TEST(Continuum, PushAddsMomentumAroundThePoint) {
  fixture::FreeBody free = random_block({Spline::quadratic, best_instruction_set()});
  const Vec3 before = free.body.momentum(free.motion), impulse(0.3, -2, 1.1);
  free.body.start(free.motion);
  free.body.push(17, impulse);
  free.body.update_grid();
  const Vec3 after = free.body.momentum(free.body.finish());
  EXPECT_LT((after - before - impulse).norm(), 1e-12 * impulse.norm() + 1e-12 * before.norm());
}

TEST(Continuum, HeldRegionsMoveAsToldAndSayWhatItTook) {
  fixture::FreeBody free = random_block({Spline::quadratic, best_instruction_set()}, 0);
  const Vec3 pull(0.5, 0, 0);
  const Box left(Vec3(-2, -2, -2), Vec3(-0.2, 2, 2)), right(Vec3(0.2, -2, -2), Vec3(2, 2, 2));
  free.body.hold({{left, -pull, {true, true, true}}, {right, pull, {true, false, false}}});
  const Vec3 before = free.body.momentum(free.motion);
  free.body.start(free.motion);
  free.body.update_grid();
  const auto motion = free.body.finish();
  EXPECT_LT((free.body.momentum(motion) - before - free.body.held_impulses()[0] - free.body.held_impulses()[1]).norm(),
            1e-12 * before.norm());
  EXPECT_EQ(free.body.held_impulses()[1][1], 0);
  int held = 0;
  for (int id = 0; id < free.body.size(); ++id) {
    const double x = free.body.material_position(id)[0];
    const Vec3 v = motion[static_cast<std::size_t>(id)].velocity;
    if (x < -0.2 - 1.5 * cell) {
      EXPECT_LT((v + pull).norm(), 1e-14);
      ++held;
    }
    if (x > 0.2 + 1.5 * cell) {
      EXPECT_NEAR(v[0], pull[0], 1e-14);
      EXPECT_GT(std::abs(v[1]), 1e-6);
    }
  }
  EXPECT_GT(held, 0);
}

TEST(Continuum, RestsWithoutALoad) {
  const fixture::Body block = fixture::block(Vec3::Constant(0.5), cell / 2);
  fixture::FreeBody free(block.points, 1e-4, fixture::rubber(),
                         fixture::continuum_settings(cell, time_step, Vec3::Zero()));
  for (int n = 0; n < 10; ++n) {
    free.body.advance(n * time_step);
    free.body.update_grid();
  }
  for (const Motion& m : free.body.finish()) EXPECT_EQ(m.velocity, Vec3(Vec3::Zero()));
  EXPECT_TRUE(free.body.candidates().empty());
}

TEST(Continuum, CandidatesAreThoseAboveTheirThresholdWithoutACrack) {
  fixture::FreeBody free = random_block({Spline::quadratic, best_instruction_set()});
  const NeoHookean& law = free.body.elasticity();
  std::vector<int> expected;
  for (int id = 0; id < free.body.size(); ++id) {
    PointState p = free.body.point(id);
    if (id % 3 == 0) p.threshold = 2e4;
    free.body.set_point(id, p);
    const PrincipalStress s =
        principal_stress(law.cauchy_stress(p.displacement_gradient, volume_change(p.displacement_gradient)));
    if (id % 3 == 0 && s.value[2] > p.threshold) expected.push_back(id);
  }
  free.body.start(free.motion);
  std::vector<int> found = free.body.candidates();
  std::sort(found.begin(), found.end());
  EXPECT_GT(expected.size(), 50u);
  EXPECT_EQ(found, expected);
  free.body.start_crack(expected[0], 1e4, 0.1);
  EXPECT_EQ(free.body.point(expected[0]).strength, 1e4);
  EXPECT_EQ(free.body.point(expected[0]).threshold, 1e4);
}

TEST(Continuum, EnergyOfSmallStrainsIsThatOfLinearElasticity) {
  const Material m = fixture::rubber();
  fixture::FreeBody free({Vec3::Zero()}, 1e-3, m, fixture::continuum_settings(cell, time_step, Vec3::Zero()));
  const auto energy = [&](const Vec3& strain, double damage) {
    PointState p = free.body.point(0);
    p.displacement_gradient = strain.asDiagonal();
    p.damage = damage;
    free.body.set_point(0, p);
    return free.body.energy({Motion{}});
  };
  const double e = 1e-4, nu = m.poisson_ratio, whole = 0.5 * m.youngs_modulus * e * e * 1e-3;
  // Uniaxial stress of either sign.
  const StoredEnergy pulled = energy({e, -nu * e, -nu * e}, 0.25), pressed = energy({-e, nu * e, nu * e}, 0.25);
  EXPECT_NEAR(pulled.tension, 0.75 * whole, 1e-3 * whole);
  EXPECT_NEAR(pulled.compression, 0, 1e-3 * whole);
  EXPECT_NEAR(pressed.compression, whole, 1e-3 * whole);
  EXPECT_NEAR(pressed.tension, 0, 1e-3 * whole);
  Motion moving{Vec3(3, 0, 0), 2 * Mat3::Identity()};
  const double mass = m.density * 1e-3;
  EXPECT_NEAR(free.body.energy({moving}).kinetic, 0.5 * mass * (9 + 12 * cell * cell / 4), 1e-12 * mass);
}

TEST(Continuum, CrushedPointsStartAnewAsDebris) {
  fixture::FreeBody free = random_block({Spline::quadratic, best_instruction_set()}, 0);
  PointState p = free.body.point(5);
  p.displacement_gradient = Vec3(-0.9, 0, 0).asDiagonal();
  free.body.set_point(5, p);
  p = free.body.point(6);
  p.displacement_gradient = Vec3(5, 0, 0).asDiagonal();
  free.body.set_point(6, p);
  free.body.start(free.motion);
  EXPECT_EQ(free.body.resets(), 2);
  EXPECT_TRUE(free.body.failed());
  for (int id : {5, 6}) {
    EXPECT_EQ(free.body.point(id).damage, 1);
    EXPECT_EQ(free.body.displacement_gradient(id), Mat3(Mat3::Zero()));
  }
}

TEST(Continuum, NamesTheParticleThatIsNotFinite) {
  for (const Variant& variant : variants()) {
    fixture::FreeBody free = random_block(variant);
    PointState p = free.body.point(42);
    p.displacement_gradient(1, 2) = std::numeric_limits<double>::quiet_NaN();
    free.body.set_point(42, p);
    try {
      free.body.start(free.motion);
      ADD_FAILURE();
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::unstable);
      EXPECT_NE(std::string(error.what()).find("particle 42 at"), std::string::npos) << error.what();
    }
  }
}

}  // namespace
