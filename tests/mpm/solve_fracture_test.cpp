/// What comes out of solve() when things break: energy bounds, bands instead of lumps, onset.
#include <numeric>

#include <gtest/gtest.h>

#include "mpm/solve.h"
#include "tests/mpm/bodies.h"

namespace {

using namespace sunder;
using namespace sunder::mpm;

const double ball = fixture::steel_ball_mass(0.01);

struct Impact {
  const char* name;
  fixture::Body body;
  Load load;
};

std::vector<Impact> impacts(double plate_speed, double cup_speed, double sphere_speed) {
  return {{"plate", fixture::plate(), fixture::steel_ball_on_glass({0.013, 0.01, -0.02}, Vec3::UnitY(), plate_speed)},
          {"cup", fixture::cup(), fixture::steel_ball_on_glass({0.04, 0.01, 0}, Vec3::UnitX(), cup_speed, 0.01, 0.04)},
          {"sphere", fixture::sphere(),
           fixture::steel_ball_on_glass({0, 0.05, 0}, Vec3::UnitY(), sphere_speed, 0.01, 0.05)}};
}

SolveSettings with(DamageModel damage) {
  SolveSettings settings;
  settings.damage = damage;
  return settings;
}

class Fracture : public ::testing::TestWithParam<DamageModel> {};

TEST_P(Fracture, TakesNoMoreWorkThanTheImpactBrings) {
  for (const Impact& impact : impacts(20, 20, 80)) {
    const SolveResult r = fixture::run(impact.body, fixture::glass(), {impact.load}, {{ball}}, with(GetParam()));
    EXPECT_GT(r.damaged_share, 0) << impact.name;
    EXPECT_LE(r.work, 1.01 * r.impact_energy) << impact.name;
    EXPECT_GT(r.work, 0) << impact.name;
    const double impulse = r.loads[0].impulse;
    EXPECT_LT((fixture::momentum(r) + impulse * impact.load.outward).norm(), 1e-9 * impulse) << impact.name;
    EXPECT_LT(std::abs(fixture::angular_momentum(impact.body.points, r).dot(impact.load.outward)), 1e-9 * impulse * 0.1)
        << impact.name;
  }
}

TEST_P(Fracture, ATooSlowImpactDamagesNothing) {
  for (const Impact& impact : impacts(0.02, 0.02, 0.02)) {
    const SolveResult r = fixture::run(impact.body, fixture::glass(), {impact.load}, {{ball}}, with(GetParam()));
    EXPECT_EQ(r.damaged_share, 0) << impact.name;
    EXPECT_EQ(r.energy->fracture, 0) << impact.name;
    EXPECT_EQ(r.nuclei, 0) << impact.name;
    for (const ParticleState& p : r.particles) ASSERT_EQ(p.damage_time, -1);
  }
}

INSTANTIATE_TEST_SUITE_P(Models, Fracture, ::testing::Values(DamageModel::front, DamageModel::local),
                         [](const auto& model) { return model.param == DamageModel::front ? "front" : "local"; });

TEST(FrontRules, DrawBandsWhereTheLocalLawMakesLumps) {
  const Impact impact = impacts(20, 0, 0)[0];
  const SolveResult front = fixture::run(impact.body, fixture::glass(), {impact.load}, {{ball}});
  const SolveResult local =
      fixture::run(impact.body, fixture::glass(), {impact.load}, {{ball}}, with(DamageModel::local));
  const double depth = 1.5 * front.cell_size;
  const double front_lumps = fixture::lump_share(impact.body.points, front, depth);
  const double local_lumps = fixture::lump_share(impact.body.points, local, depth);
  EXPECT_GT(front.damaged_share, 0.05);
  EXPECT_LT(front_lumps, 0.05);
  EXPECT_GT(local_lumps, 2 * front_lumps);
  EXPECT_GT(front.nuclei, 0);
  EXPECT_LT(front.nuclei, 0.05 * static_cast<double>(impact.body.points.size()));
}

TEST(FrontRules, DamageIsCompleteOrNothingAndHasItsTime) {
  const Impact impact = impacts(20, 0, 0)[0];
  const SolveResult r = fixture::run(impact.body, fixture::glass(), {impact.load}, {{ball}});
  for (const ParticleState& p : r.particles) {
    EXPECT_GE(p.damage, 0);
    EXPECT_LE(p.damage, 1);
    EXPECT_EQ(p.damage_time >= 0, p.damage >= 0.99);
    EXPECT_LE(p.damage_time, r.duration);
  }
  EXPECT_GT(r.energy->fracture, 0);
  EXPECT_LT(r.energy->fracture, r.impact_energy);
}

TEST(FrontRules, ReportWhatTheGridDoesToTheMaterial) {
  const Impact impact = impacts(5, 0, 0)[0];
  const SolveResult r = fixture::run(impact.body, fixture::glass(), {impact.load}, {{ball}});
  EXPECT_NEAR(r.cell_size, 0.008, 1e-12);
  EXPECT_NEAR(r.band_width, 2.2 * r.cell_size, 1e-15);
  EXPECT_NEAR(r.admissible_length, 0.7e-3, 1e-12);
  // sqrt(2 E k G_f / (1.1 l)).
  EXPECT_NEAR(r.propagation_strength, std::sqrt(2 * 70e9 * FrontSettings{}.energy_factor * 8 / (1.1 * r.band_width)), 1e-6);
}

}  // namespace
