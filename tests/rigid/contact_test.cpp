#include <gtest/gtest.h>

#include "validation/moving_bodies.h"

namespace sunder::rigid {
namespace {

using namespace setup;

constexpr double sizes[] = {0.005, 0.02, 0.1, 1};

// A box whose edge is `size`, a tetrahedron of the same reach: how far the lowest corner ends from the ground, in
// sizes.
TEST(Contact, RestingBodiesNeitherFloatNorSink) {
  for (double size : sizes) {
    World world(on_ground());
    const BodyId cube = world.add(box(Vec3::Constant(size / 2), Vec3(0, 0.6 * size, 0)));
    const BodyId tetra = world.add(tetrahedron(size / 2, Vec3(4 * size, 0.2 * size, 0)));
    run(world, 2);
    EXPECT_NEAR(world.state(cube).pose.position.y() / size, 0.5, 0.005) << size;
    EXPECT_NEAR(world.state(tetra).pose.position.y() / size, 1.0 / 6, 0.005) << size;
    EXPECT_LT(fastest(world), 1e-3);
  }
}

TEST(Contact, BodiesRestOnEachOtherWithoutAGap) {
  for (double size : sizes) {
    World world(on_ground());
    world.add(box(Vec3::Constant(size / 2), Vec3(0, 0.5 * size, 0)));
    const BodyId top = world.add(box(Vec3::Constant(size / 2), Vec3(0, 1.6 * size, 0)));
    run(world, 2);
    EXPECT_NEAR(world.state(top).pose.position.y() / size, 1.5, 0.005) << size;
  }
}

// Highest point of the n-th flight after a drop.
std::vector<double> rebounds(double size, double height, double restitution, double seconds) {
  World world(on_ground(restitution));
  BodySetup setup = ball(size / 2, Vec3(0, size / 2 + height, 0));
  setup.restitution = 1;
  const BodyId id = world.add(setup);
  std::vector<double> tops;
  double before = 0;
  for (int i = 0; i < std::lround(seconds * 480); ++i) {
    world.step();
    const double speed = world.state(id).twist.linear.y();
    if (before > 1e-6 && speed <= 0) tops.push_back(world.state(id).pose.position.y() - size / 2);
    before = speed;
  }
  return tops;
}

// D3: e^2 h, then e^4 h.
TEST(Contact, ReboundHeightIsRestitutionSquared) {
  for (double size : sizes) {
    for (double height : {0.3, 1.0}) {
      const std::vector<double> tops = rebounds(size, height, 0.5, 2);
      ASSERT_GE(tops.size(), 2u);
      EXPECT_NEAR(tops[0] / height, 0.25, 0.05 * 0.25) << size << " " << height;
      EXPECT_NEAR(tops[1] / height, 0.0625, 0.05 * 0.0625) << size << " " << height;
    }
  }
}

TEST(Contact, PlasticBodyDoesNotBounce) {
  for (double size : sizes) EXPECT_TRUE(rebounds(size, 0.5, 0, 1).empty()) << size;
}

// D3: all bounces together last t0 (1 + e) / (1 - e), t0 = sqrt(2 h / g).
TEST(Contact, BouncingStopsInTime) {
  World world(on_ground(0.5));
  BodySetup setup = ball(0.05, Vec3(0, 1.05, 0));
  setup.restitution = 1;
  const BodyId id = world.add(setup);
  double last = 0;
  while (world.time() < 3) {
    world.step();
    if (std::abs(world.state(id).twist.linear.y()) > 0.05) last = world.time();
  }
  const double expected = std::sqrt(2 / 9.81) * 3;
  EXPECT_NEAR(last / expected, 1, 0.05);
}

// D3: on an incline of slope angle a, g (sin - mu cos); gravity is tilted instead of the ground.
double slide(double angle, double friction, double size) {
  WorldSettings settings = on_ground(0, friction);
  settings.gravity = 9.81 * Vec3(std::sin(angle), -std::cos(angle), 0);
  World world(settings);
  BodySetup setup = box(Vec3(size, size / 4, size), Vec3(0, size / 4, 0));
  setup.friction = friction;
  const BodyId id = world.add(setup);
  run(world, 0.5);
  return world.state(id).twist.linear.x() / 0.5;
}

TEST(Contact, FrictionOnAnInclineIsCoulombs) {
  for (double size : sizes) {
    const double angle = 0.6, friction = 0.4;
    const double expected = 9.81 * (std::sin(angle) - friction * std::cos(angle));
    EXPECT_NEAR(slide(angle, friction, size) / expected, 1, 0.03) << size;
    EXPECT_LT(slide(0.3, 0.4, size), 1e-3) << size;
  }
}

// D7.
TEST(Contact, TowerStands) {
  for (double size : {0.01, 0.1, 1.0}) {
    World world(on_ground());
    std::vector<BodyId> ids;
    for (int i = 0; i < 5; ++i) ids.push_back(world.add(box(Vec3::Constant(size / 2), Vec3(0, (i + 0.5) * size, 0))));
    run(world, 10);
    for (int i = 0; i < 5; ++i) {
      const Vec3 moved = world.state(ids[i]).pose.position - Vec3(0, (i + 0.5) * size, 0);
      EXPECT_LT(moved.norm() / size, 0.01) << size << " box " << i;
    }
  }
}

TEST(Contact, CompoundTouchesWithEachOfItsParts) {
  World world(on_ground());
  // A table: a plate with two wide legs; it stands on the legs.
  BodySetup table = box(Vec3(0.1, 0.01, 0.1), Vec3(0, 0.1, 0));
  table.hulls.push_back(corners_of_box(Vec3(0.01, 0.04, 0.1), Vec3(-0.09, -0.05, 0)));
  table.hulls.push_back(corners_of_box(Vec3(0.01, 0.04, 0.1), Vec3(0.09, -0.05, 0)));
  const BodyId id = world.add(table);
  // A ball under it fits between the legs.
  const BodyId small = world.add(ball(0.03, Vec3(0, 0.03, 0)));
  run(world, 2);
  EXPECT_NEAR(world.state(id).pose.position.y(), 0.09, 1e-4);
  EXPECT_NEAR(world.state(small).pose.position.y(), 0.03, 1e-3);
  EXPECT_TRUE(world.overlaps().empty());
}

}  // namespace
}  // namespace sunder::rigid
