#include "rigid/world.h"

#include <algorithm>
#include <limits>

#include <gtest/gtest.h>

#include "core/error.h"
#include "validation/moving_bodies.h"

namespace sunder::rigid {
namespace {

using namespace setup;

TEST(World, ACopyCountsOn) {
  World world = pile(3);
  World copy(on_ground(), world.state());
  EXPECT_EQ(copy.bodies(), world.bodies());
  EXPECT_EQ(copy.add(box(Vec3::Constant(0.1), Vec3(9, 1, 0))), world.add(box(Vec3::Constant(0.1), Vec3(9, 1, 0))));
}

// Each group of bodies is taken through the step by itself: a bullet in one corner makes nothing finer in another.
TEST(World, GroupsThatCannotMeetDoNotChangeEachOther) {
  World alone = pile(10), together = pile(10);
  BodySetup target = box(Vec3::Constant(0.05), Vec3(50, 0.05, 0)), bullet = ball(0.005, Vec3(49, 0.05, 0), 7850);
  bullet.twist.linear = Vec3(300, 0, 0);
  together.add(target);
  together.add(bullet);
  long finest = 0;
  for (int i = 0; i < 300; ++i) {
    alone.step();
    together.step();
    finest = std::max(finest, together.work().sub_steps);
    for (BodyId id : alone.bodies()) {
      ASSERT_EQ(together.state(id).pose.position, alone.state(id).pose.position) << i;
      ASSERT_EQ(together.state(id).twist.angular, alone.state(id).twist.angular) << i;
    }
  }
  EXPECT_GT(finest, 10) << "the bullet was followed";
}

TEST(World, SleepingBodiesCostNothing) {
  World world = pile(20);
  run(world, 8);
  world.step();
  EXPECT_EQ(world.work().steps, 1);
  EXPECT_EQ(world.work().sub_steps, 0) << "something is still awake after 8 s";
  EXPECT_EQ(world.work().contacts, 0);
}

TEST(World, DrivenBodiesArriveWhereTheyAreTold) {
  World world(on_ground());
  BodySetup setup = box(Vec3(0.1, 0.05, 0.1), Vec3(0, 0.05, 0));
  setup.motion = Motion::kinematic;
  const BodyId lift = world.add(setup);
  const BodyId rider = world.add(box(Vec3::Constant(0.05), Vec3(0, 0.15, 0)));
  run(world, 3);
  Pose target;
  for (int i = 1; i <= 240; ++i) {
    target.position = Vec3(0, 0.05 + 0.3 * i / 240.0, 0);
    target.orientation = Quat(Eigen::AngleAxisd(0.004 * i, Vec3::UnitY()));
    world.drive(lift, target);
    world.step();
    ASSERT_LT((world.state(lift).pose.position - target.position).norm(), 1e-12) << i;
    ASSERT_LT(world.state(lift).pose.orientation.angularDistance(target.orientation), 1e-7) << i;
  }
  world.drive(lift, target);
  run(world, 1);
  EXPECT_NEAR(world.state(rider).pose.position.y(), 0.45, 2e-3);
  EXPECT_THROW(world.drive(rider, target), Error);
}

TEST(World, RestoreLeavesNewAndRemovedBodiesAlone) {
  World world(weightless());
  const BodyId stays = world.add(box(Vec3::Constant(0.1), Vec3::Zero()));
  const BodyId goes = world.add(box(Vec3::Constant(0.1), Vec3(1, 0, 0)));
  const World::Snapshot before = world.snapshot();
  world.step();
  world.remove(goes);
  const BodyId comes = world.add(box(Vec3::Constant(0.1), Vec3(2, 0, 0)));
  world.restore(before);
  EXPECT_EQ(world.bodies(), (std::vector<BodyId>{stays, comes}));
  EXPECT_EQ(world.time(), 0);
  EXPECT_EQ(world.state(comes).pose.position, Vec3(2, 0, 0));
  EXPECT_GT(comes, goes);
  EXPECT_THROW(world.state(goes), Error);
}

// The step back of a fracture: the same overlap is tolerated again.
TEST(World, RestoreBringsBackToleratedOverlaps) {
  World world(weightless());
  BodySetup left = box(Vec3::Constant(0.1), Vec3::Zero()), right = box(Vec3::Constant(0.1), Vec3(0.19, 0, 0));
  left.family = right.family = 1;
  world.add(left);
  const BodyId id = world.add(right);
  world.step();
  const World::Snapshot before = world.snapshot();
  BodyState parted = world.state(id);
  parted.pose.position.x() = 0.5;
  world.set_state(id, parted);
  world.step();
  world.restore(before);
  run(world, 0.2);
  EXPECT_LT(fastest(world), 1e-6);
  EXPECT_TRUE(world.overlaps().empty());
}

TEST(World, BodiesFallAsleepAndWakeWhenHit) {
  World world(on_ground());
  const BodyId sleeper = world.add(box(Vec3::Constant(0.05), Vec3(0, 0.05, 0)));
  run(world, 3);
  EXPECT_EQ(world.state(sleeper).twist.linear, Vec3::Zero());
  BodySetup hammer = ball(0.03, Vec3(-0.3, 0.06, 0), 7850);
  hammer.twist.linear = Vec3(4, 0, 0);
  world.add(hammer);
  const std::vector<Impact> hits = run(world, 0.3);
  ASSERT_FALSE(hits.empty());
  EXPECT_EQ(hits[0].body_a, sleeper);
  EXPECT_GT(world.state(sleeper).pose.position.x(), 0.1);
}

TEST(World, RemovingTheSupportWakesWhatRestedOnIt) {
  for (Motion motion : {Motion::dynamic, Motion::fixed}) {
    World world(on_ground());
    BodySetup base = box(Vec3::Constant(0.05), Vec3(0, 0.05, 0));
    base.motion = motion;
    const BodyId support = world.add(base);
    const BodyId middle = world.add(box(Vec3::Constant(0.05), Vec3(0, 0.15, 0)));
    const BodyId top = world.add(box(Vec3::Constant(0.05), Vec3(0, 0.25, 0)));
    run(world, 4);
    EXPECT_EQ(world.state(top).twist.linear, Vec3::Zero());
    world.remove(support);
    run(world, 1);
    EXPECT_NEAR(world.state(middle).pose.position.y(), 0.05, 1e-3);
    EXPECT_NEAR(world.state(top).pose.position.y(), 0.15, 1e-3);
  }
}

TEST(World, MovingTheSupportWakesWhatRestedOnIt) {
  World world(on_ground());
  BodySetup lift = box(Vec3(0.1, 0.05, 0.1), Vec3(0, 0.05, 0));
  lift.motion = Motion::kinematic;
  const BodyId platform = world.add(lift);
  const BodyId rider = world.add(box(Vec3::Constant(0.05), Vec3(0, 0.15, 0)));
  run(world, 4);
  EXPECT_EQ(world.state(rider).twist.linear, Vec3::Zero());
  BodyState up = world.state(platform);
  up.twist.linear = Vec3(0, 0.1, 0);
  world.set_state(platform, up);
  run(world, 1);
  EXPECT_NEAR(world.state(rider).pose.position.y(), 0.25, 2e-3);
}

// Asleep they stand like fixed bodies, but a hit goes through the whole row within a step.
TEST(World, AHitWakesARowOfSleepers) {
  World world(on_ground(1, 0));
  std::vector<BodyId> row;
  for (int i = 0; i < 5; ++i) {
    BodySetup setup = box(Vec3::Constant(0.05), Vec3(0.1 * i, 0.05, 0));
    setup.friction = 0;
    row.push_back(world.add(setup));
  }
  run(world, 2);
  BodySetup hammer = box(Vec3::Constant(0.05), Vec3(-0.2, 0.05, 0));
  hammer.friction = 0;
  hammer.twist.linear = Vec3(3, 0, 0);
  world.add(hammer);
  run(world, 0.2);
  double momentum = 0;
  for (BodyId id : world.bodies()) momentum += world.mass(id) * world.state(id).twist.linear.x();
  EXPECT_NEAR(momentum, hammer.mass * 3, 0.01 * hammer.mass * 3);
  EXPECT_GT(world.state(row.back()).twist.linear.x(), 0.1);
}

TEST(World, OneRollingBallDoesNotKeepAHeapAwake) {
  World world = pile(20);
  run(world, 6);
  BodySetup marble = ball(0.002, Vec3(0, 0.5, 0));
  const BodyId id = world.add(marble);
  const auto asleep = [&] {
    const World::Snapshot now = world.snapshot();
    return std::count_if(now.rests.begin(), now.rests.end(), [](const auto& rest) { return rest.asleep; });
  };
  const auto before = asleep();
  EXPECT_GE(before, 15);
  run(world, 0.5);
  EXPECT_GE(asleep(), before - 2) << "a marble of 2 mm woke them; it is at " << world.state(id).pose.position.y();
}

TEST(World, FreeBodiesNeverFallAsleep) {
  World world(weightless());
  BodySetup setup = box(Vec3::Constant(0.05), Vec3::Zero());
  setup.twist = {Vec3(1e-5, 0, 0), Vec3(0, 1e-5, 0)};
  const BodyId id = world.add(setup);
  run(world, 5);
  EXPECT_NEAR(world.state(id).pose.position.x(), 5e-5, 1e-12);
}

TEST(World, OverlapsNameTheDeepestFirst) {
  World world(on_ground());
  const BodyId sunk = world.add(box(Vec3::Constant(0.1), Vec3(0, 0.07, 0)));
  const BodyId beside = world.add(box(Vec3::Constant(0.1), Vec3(0.19, 0.1, 0)));
  world.add(box(Vec3::Constant(0.1), Vec3(2, 0.1, 0)));
  const std::vector<World::Overlap> overlaps = world.overlaps();
  ASSERT_EQ(overlaps.size(), 2u);
  EXPECT_EQ(overlaps[0].body_a, sunk);
  EXPECT_EQ(overlaps[0].body_b, ground_id);
  EXPECT_NEAR(overlaps[0].depth, 0.03, 1e-9);
  EXPECT_EQ(overlaps[1].body_b, beside);
  EXPECT_NEAR(overlaps[1].depth, 0.01, 1e-9);
}

void expect_refused(const BodySetup& setup, const std::string& word) {
  World world{WorldSettings()};
  try {
    world.add(setup);
    FAIL() << "accepted: " << word;
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::usage);
    EXPECT_NE(std::string(error.what()).find(word), std::string::npos) << error.what();
  }
  EXPECT_TRUE(world.bodies().empty());
}

TEST(World, BadBodiesAreRefusedByName) {
  const double nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();
  const BodySetup good = box(Vec3::Constant(0.1), Vec3::Zero());
  for (double mass : {0.0, -1.0, nan, infinity}) {
    BodySetup bad = good;
    bad.mass = mass;
    expect_refused(bad, "mass");
  }
  BodySetup bad = good;
  bad.inertia(1, 1) = nan;
  expect_refused(bad, "inertia");
  bad = good;
  bad.inertia(0, 0) = -1;
  expect_refused(bad, "inertia");
  bad = good;
  bad.inertia(0, 1) = 1;
  expect_refused(bad, "symmetric");
  bad = good;
  bad.hulls.clear();
  expect_refused(bad, "hull");
  bad = good;
  bad.hulls = {corners_of_box(Vec3(1, 1, 0))};
  expect_refused(bad, "hull");
  bad = good;
  bad.hulls[0].vertices[3].x() = nan;
  expect_refused(bad, "hull");
  bad = good;
  bad.pose.position.y() = infinity;
  expect_refused(bad, "finite");
  bad = good;
  bad.restitution = 1.5;
  expect_refused(bad, "restitution");
}

TEST(World, FixedBodiesNeedNoMass) {
  World world{WorldSettings()};
  BodySetup setup = box(Vec3::Constant(0.1), Vec3::Zero());
  setup.mass = -1;
  setup.inertia.setZero();
  setup.motion = Motion::fixed;
  const BodyId id = world.add(setup);
  run(world, 0.1);
  EXPECT_EQ(world.state(id).pose.position, Vec3::Zero());
}

TEST(World, CanBeMoved) {
  World world = pile(3);
  World other = std::move(world);
  EXPECT_EQ(other.bodies().size(), 3u);
  other.step();
}

}  // namespace
}  // namespace sunder::rigid
