#include <gtest/gtest.h>

#include "validation/moving_bodies.h"

namespace sunder::rigid {
namespace {

using namespace setup;

// Two bodies on a line: impulse = (1 + e) m v / 2 for equal masses.
TEST(Impact, HeadOnCollisionReportsWhatHappened) {
  World world(weightless());
  const double radius = 0.05, speed = 3, restitution = 0.5;
  BodySetup left = bouncy_ball(radius, Vec3(-0.2, 0, 0), Vec3(speed, 0, 0));
  BodySetup right = bouncy_ball(radius, Vec3(0.2, 0, 0), Vec3::Zero());
  left.restitution = restitution;
  const BodyId a = world.add(left), b = world.add(right);
  const std::vector<Impact> all = run(world, 0.3);
  ASSERT_EQ(all.size(), 1u);
  const Impact& hit = all[0];
  EXPECT_EQ(hit.body_a, a);
  EXPECT_EQ(hit.body_b, b);
  EXPECT_NEAR(hit.impulse / (left.mass * speed * (1 + restitution) / 2), 1, 1e-6);
  EXPECT_NEAR(hit.approach_speed, speed, 1e-9);
  EXPECT_LT((hit.normal - Vec3(-1, 0, 0)).norm(), 1e-9);
  EXPECT_LT((hit.point - Vec3(0.15, 0, 0)).norm(), 1e-9);
  EXPECT_NEAR(world.state(a).twist.linear.x(), speed * (1 - restitution) / 2, 1e-6);
  EXPECT_NEAR(world.state(b).twist.linear.x(), speed * (1 + restitution) / 2, 1e-6);
}

TEST(Impact, RestingBodiesReportNone) {
  World world(on_ground());
  world.add(box(Vec3::Constant(0.05), Vec3(0, 0.05, 0)));
  world.add(box(Vec3::Constant(0.05), Vec3(0, 0.15, 0)));
  EXPECT_TRUE(run(world, 1).empty());
}

TEST(Impact, GroundHitCarriesTheMomentum) {
  World world(on_ground(0.5));
  BodySetup setup = ball(0.05, Vec3(0, 0.55, 0));
  setup.restitution = 1;
  world.add(setup);
  const std::vector<Impact> all = run(world, 0.4);
  ASSERT_EQ(all.size(), 1u);
  const double speed = std::sqrt(2 * 9.81 * 0.5);
  EXPECT_EQ(all[0].body_b, ground_id);
  EXPECT_LT((all[0].normal - Vec3::UnitY()).norm(), 1e-12);
  EXPECT_NEAR(all[0].approach_speed / speed, 1, 0.02);
  EXPECT_NEAR(all[0].impulse / (setup.mass * 1.5 * speed), 1, 0.02);
}

// Far corners are patches of their own, near points are one.
TEST(Impact, PointsThatLieTogetherAreOnePatch) {
  World world(on_ground(0));
  BodySetup plate = box(Vec3(0.1, 0.01, 0.1), Vec3(0, 0.2, 0));
  BodySetup post = box(Vec3(0.005, 0.1, 0.005), Vec3(1, 0.3, 0));
  const BodyId wide = world.add(plate), narrow = world.add(post);
  int of_wide = 0, of_narrow = 0;
  double impulse = 0;
  for (const Impact& hit : run(world, 0.25)) {
    (hit.body_a == wide ? of_wide : of_narrow) += 1;
    if (hit.body_a == wide) impulse += hit.impulse;
  }
  EXPECT_EQ(of_wide, 4);
  EXPECT_EQ(of_narrow, 1) << narrow;
  EXPECT_NEAR(impulse / (plate.mass * std::sqrt(2 * 9.81 * 0.19)), 1, 0.03);
}

struct Shot {
  double speed, offset;
};

// A 2 cm steel ball against a 1 cm plate: no passage, and an impact at the plate's face with the normal across it.
TEST(Impact, FastSmallBallDoesNotPassAThinPlate) {
  for (const Shot& shot : {Shot{120, 0}, Shot{120, 0.0307}, Shot{300, 0.011}, Shot{37, -0.02}}) {
    World world{WorldSettings()};
    BodySetup plate = box(Vec3(0.2, 0.2, 0.005), Vec3::Zero(), 2500);
    plate.motion = Motion::fixed;
    BodySetup bullet = ball(0.01, Vec3(shot.offset, 0, 0.777), 7850);
    bullet.twist.linear = Vec3(0, 0, -shot.speed);
    const BodyId target = world.add(plate), id = world.add(bullet);
    const std::vector<Impact> all = run(world, 0.05);
    ASSERT_EQ(all.size(), 1u) << shot.speed;
    const Impact& hit = all[0];
    EXPECT_EQ(hit.body_a, target);
    EXPECT_LT((hit.normal - Vec3(0, 0, -1)).norm(), 1e-3);
    EXPECT_NEAR(hit.approach_speed / shot.speed, 1, 1e-3);
    EXPECT_NEAR(hit.point.z(), 0.005, 1e-6);
    EXPECT_NEAR(hit.point.x(), shot.offset, 1e-6);
    EXPECT_NEAR(hit.impulse / (bullet.mass * shot.speed), 1.09, 0.01);
    EXPECT_GT(world.state(id).pose.position.z(), 0.015);
  }
}

// Both move: a spinning bar and a fast ball. Momentum is what the impact says.
TEST(Impact, ImpulseExplainsTheChangeOfMotion) {
  World world(weightless());
  BodySetup bar = box(Vec3(0.1, 0.01, 0.02), Vec3::Zero());
  bar.twist.angular = Vec3(0, 0, 20);
  BodySetup bullet = bouncy_ball(0.01, Vec3(0.08, 0.3, 0), Vec3(0, -40, 0));
  const BodyId a = world.add(bar), b = world.add(bullet);
  bar.friction = 0;
  Impact hit;
  while (hit.impulse == 0 && world.time() < 0.1)
    for (const Impact& impact : world.step()) hit = impact;
  ASSERT_GT(hit.impulse, 0);
  const Vec3 push_a = bar.mass * (world.state(a).twist.linear - bar.twist.linear);
  const Vec3 push_b = bullet.mass * (world.state(b).twist.linear - bullet.twist.linear);
  EXPECT_LT((push_a + push_b).norm(), 1e-9 * hit.impulse);
  EXPECT_LT((push_a - hit.impulse * hit.normal).norm(), 1e-6 * hit.impulse);
}

}  // namespace
}  // namespace sunder::rigid
