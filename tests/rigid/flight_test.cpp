#include <gtest/gtest.h>

#include "validation/moving_bodies.h"

namespace sunder::rigid {
namespace {

using namespace setup;

constexpr double rounding = 1e-12;

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
