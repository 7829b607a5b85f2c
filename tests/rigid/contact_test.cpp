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
