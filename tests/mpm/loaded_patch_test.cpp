#include "mpm/loaded_patch.h"

#include <gtest/gtest.h>

#include "tests/mpm/bodies.h"
#include "tests/mpm/free_body.h"

namespace {

using namespace sunder;
using namespace sunder::mpm;

constexpr double spacing = 0.004, h = 2 * spacing;

fixture::FreeBody slab() {
  const fixture::Body body = fixture::plate(spacing, 0);
  return {body.points, std::pow(spacing, 3), 1000, h, Vec3::Zero()};
}

const Vec3 top(0, 0.01, 0);

TEST(LoadedPatch, ImpulseArrivesWholeAndAlongTheNormal) {
  fixture::FreeBody body = slab();
  const LoadedPatch patch(body.particles, top, Vec3::UnitY(), 1.5 * h, h);
  patch.push(body.particles, 3.5, body.grid);
  Vec3 momentum = Vec3::Zero(), angular = Vec3::Zero();
  for (int i = 0; i < body.grid.size(0); ++i)
    for (int j = 0; j < body.grid.size(1); ++j)
      for (int k = 0; k < body.grid.size(2); ++k) {
        const Vec3 p = body.grid.node(body.grid.index(i, j, k)).head<3>();
        momentum += p;
        angular += (body.grid.origin() + h * Vec3(i, j, k)).cross(p);
      }
  EXPECT_LT((momentum - Vec3(0, -3.5, 0)).norm(), 1e-12);
  // The lattice is symmetric about the axis of the load.
  EXPECT_LT(angular.norm(), 1e-12);
}

TEST(LoadedPatch, IndentationIsTheRigidDisplacementAgainstTheNormal) {
  fixture::FreeBody body = slab();
  const LoadedPatch patch(body.particles, top, Vec3::UnitY(), 1.5 * h, h);
  EXPECT_EQ(patch.indentation(body.particles), 0);
  for (Particle& p : body.particles) p.displacement = Vec3(0.3, -2e-5, 0.1);
  EXPECT_NEAR(patch.indentation(body.particles), 2e-5, 1e-18);
}

TEST(LoadedPatch, HoldsTheMaterialBelowTheContactOnly) {
  fixture::FreeBody body = slab();
  const double radius = 1.5 * h, depth = 0.6 * radius + 0.5 * h;
  const LoadedPatch patch(body.particles, top, Vec3::UnitY(), radius, h);
  for (Particle& p : body.particles) {
    p.displacement = Vec3(0, -1, 0);
    const double weight = patch.indentation(body.particles);
    p.displacement = Vec3::Zero();
    const double off = std::hypot(p.material_position[0], p.material_position[2]);
    if (off < radius && top[1] - p.material_position[1] <= depth) {
      EXPECT_GT(weight, 0);
    } else {
      EXPECT_EQ(weight, 0);
    }
  }
}

TEST(LoadedPatch, FallsBackToTheNearestParticle) {
  fixture::FreeBody body = slab();
  const LoadedPatch patch(body.particles, {0.001, 0.1, 0.001}, Vec3::UnitY(), 1e-6, 1e-6);
  body.particles.front().displacement = Vec3(0, -1, 0);
  EXPECT_EQ(patch.indentation(body.particles), 0);
  for (Particle& p : body.particles) p.displacement = Vec3(0, -1, 0);
  EXPECT_EQ(patch.indentation(body.particles), 1);
}

TEST(LoadedPatch, LetsGoOfWhatEscaped) {
  fixture::FreeBody body = slab();
  LoadedPatch patch(body.particles, top, Vec3::UnitY(), 1.5 * h, h);
  for (Particle& p : body.particles) {
    p.displacement = Vec3(0, -1e-5, 0);
    if (p.material_position[0] > 0) {
      p.escaped = true;
      p.displacement = Vec3(0, 100, 0);
    }
  }
  EXPECT_TRUE(patch.drop_escaped(body.particles));
  EXPECT_NEAR(patch.indentation(body.particles), 1e-5, 1e-18);
  for (Particle& p : body.particles) p.escaped = true;
  EXPECT_FALSE(patch.drop_escaped(body.particles));
}

}  // namespace
