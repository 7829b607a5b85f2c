#include <gtest/gtest.h>

#include "validation/moving_bodies.h"

namespace sunder::rigid {
namespace {

using namespace setup;

constexpr double rounding = 1e-12;

// Symplectic Euler falls n (n + 1) / 2 steps instead of n^2 / 2: the error is g t dt / 2.
TEST(Flight, ParabolaHasTheErrorOfSymplecticEuler) {
  WorldSettings settings;
  World world(settings);
  BodySetup setup = box(Vec3(0.1, 0.2, 0.3), Vec3(1, 2, 3));
  setup.twist.linear = Vec3(0.5, 4, -0.25);
  const BodyId id = world.add(setup);
  const double t = 1;
  run(world, t);
  const Vec3 exact = setup.pose.position + setup.twist.linear * t + settings.gravity * (t * t / 2);
  const Vec3 expected = exact + settings.gravity * (t * settings.time_step / 2);
  EXPECT_LT((world.state(id).pose.position - expected).norm(), 1e-10);
  EXPECT_NEAR(world.time(), t, rounding);
}

struct Top {
  double energy_drift = 0, momentum_drift = 0;
  std::vector<double> flips;
};

Top spin_top(const Mat3& inertia, const Quat& orientation, const Vec3& angular, double seconds) {
  WorldSettings settings = weightless();
  settings.time_step = 1e-3;
  World world(settings);
  BodySetup setup = box(Vec3(0.3, 0.2, 0.1), Vec3::Zero());
  setup.mass = 6;
  setup.inertia = inertia;
  setup.pose.orientation = orientation;
  setup.twist.angular = angular;
  const BodyId id = world.add(setup);
  const double energy = kinetic_energy(world);
  const Vec3 momentum = world.world_inertia(id) * angular;
  Top top;
  double sign = 1;
  for (int i = 0; i < std::lround(seconds / settings.time_step); ++i) {
    world.step();
    const BodyState state = world.state(id);
    top.energy_drift = std::max(top.energy_drift, std::abs(kinetic_energy(world) / energy - 1));
    top.momentum_drift = std::max(top.momentum_drift,
                                  (world.world_inertia(id) * state.twist.angular - momentum).norm() / momentum.norm());
    const double along = (state.pose.orientation.conjugate() * state.twist.angular).y();
    if (along * sign < 0) top.flips.push_back(world.time()), sign = -sign;
  }
  return top;
}

TEST(Flight, FreeTopKeepsEnergyAndAngularMomentum) {
  const Top top = spin_top(Vec3(1, 2, 3).asDiagonal(), Quat::Identity(), Vec3(1, 5, 0.5), 10);
  EXPECT_LT(top.energy_drift, 1e-6);
  EXPECT_LT(top.momentum_drift, 1e-10);
}

// Euler's equations in body axes by RK4: the times at which the middle axis changes sides.
std::vector<double> euler_flips(const Vec3& moments, Vec3 w, double seconds, double dt) {
  const auto rate = [&](const Vec3& x) { return Vec3(-x.cross(moments.cwiseProduct(x)).cwiseQuotient(moments)); };
  std::vector<double> flips;
  double sign = 1;
  for (int i = 0; i < std::lround(seconds / dt); ++i) {
    const Vec3 a = rate(w), b = rate(w + dt / 2 * a), c = rate(w + dt / 2 * b), d = rate(w + dt * c);
    w += dt / 6 * (a + 2 * b + 2 * c + d);
    if (w.y() * sign < 0) flips.push_back((i + 1) * dt), sign = -sign;
  }
  return flips;
}

TEST(Flight, MiddleAxisFlipsWithTheRightPeriod) {
  const Vec3 moments(1, 2, 3), angular(0.01, 5, 0.01);
  const std::vector<double> expected = euler_flips(moments, angular, 10, 1e-4);
  const Top top = spin_top(moments.asDiagonal(), Quat::Identity(), angular, 10);
  ASSERT_GE(expected.size(), 2u);
  ASSERT_EQ(top.flips.size(), expected.size());
  EXPECT_NEAR((top.flips[1] - top.flips[0]) / (expected[1] - expected[0]), 1, 0.02);
}

// The frame of the user is not the principal one: the same top with turned body axes moves the same.
TEST(Flight, FullInertiaMovesLikeItsDiagonalForm) {
  const Quat axes = random_turn(1, 0);
  const Mat3 turn = axes.toRotationMatrix();
  const Mat3 diagonal = Vec3(1, 2, 3).asDiagonal();
  const auto end = [&](const Mat3& inertia, const Quat& orientation) {
    World world(weightless());
    BodySetup setup = box(Vec3(0.3, 0.2, 0.1), Vec3::Zero());
    setup.inertia = inertia;
    setup.pose.orientation = orientation;
    setup.twist.angular = Vec3(1, 5, 0.5);
    const BodyId id = world.add(setup);
    EXPECT_LT((world.state(id).pose.orientation.toRotationMatrix() - orientation.toRotationMatrix()).norm(), rounding);
    EXPECT_LT((world.world_inertia(id) - orientation * inertia * orientation.conjugate().toRotationMatrix()).norm(),
              rounding);
    run(world, 1);
    return world.state(id);
  };
  const BodyState plain = end(diagonal, Quat::Identity());
  const BodyState turned = end(turn.transpose() * diagonal * turn, axes);
  EXPECT_LT((plain.twist.angular - turned.twist.angular).norm(), 1e-9);
  EXPECT_LT((plain.pose.orientation.toRotationMatrix() * turn - turned.pose.orientation.toRotationMatrix()).norm(),
            1e-9);
}

TEST(Flight, KinematicBodyFollowsItsTwistAndFixedBodyStays) {
  World world{WorldSettings()};
  BodySetup moving = box(Vec3(0.1, 0.1, 0.1), Vec3::Zero());
  moving.motion = Motion::kinematic;
  moving.twist = {Vec3(0.1, 0.02, 0), Vec3(0, 0.5, 0)};
  BodySetup still = box(Vec3(0.1, 0.1, 0.1), Vec3(5, 0, 0));
  still.motion = Motion::fixed;
  const BodyId kinematic = world.add(moving), fixed = world.add(still);
  run(world, 2);
  const BodyState state = world.state(kinematic);
  EXPECT_LT((state.pose.position - Vec3(0.2, 0.04, 0)).norm(), 1e-10);
  EXPECT_LT(state.pose.orientation.angularDistance(Quat(Eigen::AngleAxisd(1.0, Vec3::UnitY()))), 1e-7);
  EXPECT_EQ(state.twist.linear, moving.twist.linear);
  EXPECT_EQ(world.state(fixed).pose.position, still.pose.position);
}

// A sliver of a burst may turn a hundred times in a step; its energy must not wander off.
TEST(Flight, FastNeedlesKeepTheirEnergy) {
  for (const double thickness : {0.1, 0.01, 1e-3, 1e-4}) {
    for (const double spin : {1e2, 1e4, 1e6, 1e8}) {
      World world(weightless());
      BodySetup needle = box(Vec3(1e-3, 1e-3 * thickness, 1.3e-3 * thickness), Vec3::Zero());
      needle.twist.angular = spin * Vec3(0.01, 1, 0.3);
      const BodyId id = world.add(needle);
      const double before = kinetic_energy(world, id);
      run(world, 1);
      EXPECT_NEAR(kinetic_energy(world, id) / before, 1, 0.05) << thickness << " " << spin;
    }
  }
}

}  // namespace
}  // namespace sunder::rigid
