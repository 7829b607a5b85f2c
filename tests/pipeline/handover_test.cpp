#include "pipeline/handover.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "core/random.h"

namespace sunder::pipeline {
namespace {

/// Everything here is a handful of sums and one 3 x 3 solve.
constexpr double rounding = 1e-12;

struct Cloud {
  std::vector<RigidPart> parts;
  std::vector<Twist> twists;
};

/// Random parts of very different masses (1e-4 ... 1 kg) within a metre, in random motion.
Cloud random_cloud(std::uint64_t seed, int count) {
  std::uint64_t n = 0;
  const auto u = [&] { return random_unit(seed, 1, n++) * 2 - 1; };
  const auto vector = [&] { return Vec3(u(), u(), u()); };
  Cloud cloud;
  for (int k = 0; k < count; ++k) {
    const double mass = std::pow(10.0, 2 * u() - 2), size = 0.05 + 0.04 * u();
    const Mat3 root = Quat(u(), u(), u(), u() + 1.5).normalized().toRotationMatrix();
    const Vec3 principal = mass * size * size * (Vec3::Constant(1.0) + 0.3 * vector());
    cloud.parts.push_back({mass, vector(), root * principal.asDiagonal() * root.transpose()});
    cloud.twists.push_back({5 * vector(), 20 * vector()});
  }
  return cloud;
}

double scale_of(const Momentum& m) { return 1 + m.linear.norm() + m.angular.norm(); }

void expect_same(const Momentum& a, const Momentum& b, double tolerance) {
  EXPECT_LE((a.linear - b.linear).norm(), tolerance * scale_of(b));
  EXPECT_LE((a.angular - b.angular).norm(), tolerance * scale_of(b));
}

TEST(Handover, ARigidFieldKeepsMomentumAndEnergy) {
  const Cloud cloud = random_cloud(3, 7);
  const Momentum total{Vec3(1, -2, 0.5), Vec3(0.1, 0.3, -0.2)};
  const auto twists = rigid_motion(cloud.parts, total);
  expect_same(momentum(cloud.parts, twists), total, rounding);
  for (std::size_t k = 0; k < twists.size(); ++k) {
    const Vec3 arm = cloud.parts[k].centre - cloud.parts[0].centre;
    EXPECT_LE((twists[k].linear - twists[0].at(arm)).norm(), rounding * 10) << "v_k = v_0 + omega x r";
    EXPECT_EQ(twists[k].angular, twists[0].angular);
  }
}

RC_GTEST_PROP(Handover, AnyMomentumIsReachedToRounding, ()) {
  const auto seed = *rc::gen::inRange<std::uint64_t>(0, 1u << 30);
  const Cloud cloud = random_cloud(seed, *rc::gen::inRange(1, 40));
  const Momentum total{Vec3(0.7, 0.1, -3), Vec3(-1, 0.2, 0.4)};
  const auto twists = with_momentum(cloud.parts, cloud.twists, total);
  expect_same(momentum(cloud.parts, twists), total, rounding * 10);
}

RC_GTEST_PROP(Handover, EnergyLimitHoldsAndKeepsMomentum, ()) {
  const auto seed = *rc::gen::inRange<std::uint64_t>(0, 1u << 30);
  const Cloud cloud = random_cloud(seed, *rc::gen::inRange(2, 40));
  const double energy = kinetic_energy(cloud.parts, cloud.twists);
  const Momentum before = momentum(cloud.parts, cloud.twists);
  const double least = kinetic_energy(cloud.parts, rigid_motion(cloud.parts, before));
  const double limit = least + 0.4 * (energy - least);
  const auto twists = with_energy_limit(cloud.parts, cloud.twists, limit);
  RC_ASSERT(std::abs(kinetic_energy(cloud.parts, twists) - limit) <= 1e-10 * energy);
  expect_same(momentum(cloud.parts, twists), before, 1e-11);
}

TEST(Handover, EnoughEnergyChangesNothing) {
  const Cloud cloud = random_cloud(5, 9);
  const auto twists = with_energy_limit(cloud.parts, cloud.twists, kinetic_energy(cloud.parts, cloud.twists));
  for (std::size_t k = 0; k < twists.size(); ++k) EXPECT_EQ(twists[k].linear, cloud.twists[k].linear);
}

TEST(Handover, ALimitThatEvenRigidMotionExceedsGivesRigidMotion) {
  const Cloud cloud = random_cloud(5, 9);
  const auto rigid = rigid_motion(cloud.parts, momentum(cloud.parts, cloud.twists));
  const auto twists = with_energy_limit(cloud.parts, cloud.twists, 0);
  for (std::size_t k = 0; k < twists.size(); ++k) EXPECT_LE((twists[k].linear - rigid[k].linear).norm(), rounding);
}

TEST(Handover, AHeadOnPushIsAffordableUpToAnElasticBounce) {
  const RigidPart ball{1.0, Vec3::Zero(), Mat3::Identity()}, block{3.0, Vec3::Zero(), Mat3::Identity()};
  const Twist flies{Vec3(4, 0, 0), Vec3::Zero()}, rests;
  // An elastic bounce passes on 2 m_s v = 2 * 3/4 * 4 N s.
  const auto share = [&](double impulse) {
    return affordable_share(block, rests, {ball}, {flies}, {{Vec3(impulse, 0, 0), Vec3::Zero(), Vec3::Zero(), 0}});
  };
  EXPECT_DOUBLE_EQ(share(5.9), 1);
  EXPECT_NEAR(share(12), 0.5, rounding);
  EXPECT_DOUBLE_EQ(share(-1), 0) << "pushing against the motion only adds energy";
}

TEST(Handover, EffectiveMassAtTheEndOfARod) {
  // A thin rod answers a push across its end with a quarter of its mass.
  const double m = 2, length = 0.6, about_centre = m * length * length / 12;
  const RigidPart rod{m, Vec3::Zero(), Vec3(about_centre, about_centre, 1e-9).asDiagonal()};
  EXPECT_NEAR(effective_mass(rod, Vec3(0, 0, length / 2), Vec3::UnitY()), m / 4, rounding);
  EXPECT_DOUBLE_EQ(effective_mass(rod, Vec3(0, 0, length / 2), Vec3::UnitZ()), m);
}

}  // namespace
}  // namespace sunder::pipeline
