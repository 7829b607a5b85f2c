#include "mpm/transfer.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "tests/mpm/bodies.h"
#include "tests/mpm/free_body.h"
#include "tests/mpm/reference_step.h"

namespace {

using namespace sunder;
using namespace sunder::mpm;

constexpr double cell = 0.125;

fixture::FreeBody random_block(double spin = 0) {
  const fixture::Body body = fixture::block({0.5, 0.3, 0.4}, cell / 2, 0.2);
  fixture::FreeBody free(body.points, std::pow(cell / 2, 3), 1000, cell, Vec3::Constant(0.0371));
  std::uint64_t n = 0;
  const auto random = [&] { return 2 * random_unit(5, 1, n++) - 1; };
  for (Particle& p : free.particles) {
    p.velocity = Vec3(random(), random(), random());
    for (int k = 0; k < 9; ++k) {
      p.displacement_gradient(k / 3, k % 3) = 0.05 * random();
      p.affine_velocity(k / 3, k % 3) = 3 * random();
    }
    p.velocity += spin * Vec3::UnitZ().cross(p.material_position);
  }
  return free;
}

TEST(ParticleToGrid, ConservesMassMomentumAndAngularMomentum) {
  fixture::FreeBody body = random_block(2);
  for (Particle& p : body.particles) p.affine_momentum = body.mass * p.affine_velocity;
  particle_to_grid(body.particles, body.slabs, body.mass, body.grid);
  double mass = 0;
  Vec3 momentum = Vec3::Zero(), angular = Vec3::Zero();
  for (int i = 0; i < body.grid.size(0); ++i)
    for (int j = 0; j < body.grid.size(1); ++j)
      for (int k = 0; k < body.grid.size(2); ++k) {
        const Node& node = body.grid.node(body.grid.index(i, j, k));
        const Vec3 x = body.grid.origin() + cell * Vec3(i, j, k);
        mass += node[3];
        momentum += node.head<3>();
        angular += x.cross(Vec3(node.head<3>()));
      }
  const double total = body.mass * static_cast<double>(body.particles.size());
  EXPECT_NEAR(mass, total, 1e-12 * total);
  EXPECT_LT((momentum - body.momentum()).norm(), 1e-12 * total);
  EXPECT_LT((angular - body.angular_momentum()).norm(), 1e-12 * total);
}

// Problem A3: linear patch test.
TEST(GridToParticle, RecoversALinearVelocityFieldEverywhere) {
  fixture::FreeBody body = random_block();
  Mat3 g;
  g << 0.3, -1.2, 0.4, 2, 0.1, -0.7, 0.5, 0.9, -0.4;
  for (int i = 0; i < body.grid.size(0); ++i)
    for (int j = 0; j < body.grid.size(1); ++j)
      for (int k = 0; k < body.grid.size(2); ++k) {
        const Vec3 x = body.grid.origin() + cell * Vec3(i, j, k);
        body.grid.node(body.grid.index(i, j, k)).head<3>() = Vec3(g * x + Vec3(1, 2, 3));
      }
  const std::vector<Particle> before = body.particles;
  grid_to_particle(body.grid, body.slabs, 1e-4, body.particles);
  for (std::size_t n = 0; n < before.size(); ++n) {
    const Particle& p = body.particles[n];
    EXPECT_LT((p.affine_velocity - g).norm(), 1e-13 * 10);
    EXPECT_LT((p.velocity - (g * before[n].position() + Vec3(1, 2, 3))).norm(), 1e-13 * 10);
    const Mat3 f = (Mat3::Identity() + 1e-4 * g) * (Mat3::Identity() + before[n].displacement_gradient);
    EXPECT_LT((p.displacement_gradient - (f - Mat3::Identity())).norm(), 1e-15);
    EXPECT_EQ(p.displacement, Vec3(1e-4 * p.velocity));
  }
}

TEST(Transfer, OneStepIsThePlainReferenceStep) {
  fixture::FreeBody body = random_block(1);
  const Material material = fixture::rubber();
  const double dt = 1e-4, volume = std::pow(cell / 2, 3);
  std::vector<Particle> expected = body.particles;
  for (Particle& p : expected) p.threshold = p.strength = 1e15;
  // The grid of the reference begins elsewhere, by whole cells.
  const Vec3 origin = body.grid.origin() - cell * Vec3(2, 2, 2);
  fixture::ReferenceStep on_the_nodes(material, volume, cell, dt, 0, origin, {24, 24, 24});
  on_the_nodes(expected);
  body.step(dt, fixture::elastic(material));
  double speed = 0, gradient = 0, strain = 0;
  for (const Particle& p : expected) {
    speed = std::max(speed, p.velocity.norm());
    gradient = std::max(gradient, p.affine_velocity.norm());
    strain = std::max(strain, p.displacement_gradient.norm());
  }
  for (std::size_t n = 0; n < expected.size(); ++n) {
    EXPECT_LT((body.particles[n].velocity - expected[n].velocity).norm(), 1e-12 * speed);
    EXPECT_LT((body.particles[n].affine_velocity - expected[n].affine_velocity).norm(), 1e-12 * gradient);
    EXPECT_LT((body.particles[n].displacement_gradient - expected[n].displacement_gradient).norm(), 1e-12 * strain);
  }
}

TEST(SlabOrder, HoldsEveryParticleOnceSlabBySlab) {
  fixture::FreeBody body = random_block();
  body.particles[17].escaped = true;
  const SlabOrder slabs = slab_order(body.particles, body.grid);
  std::vector<int> seen(body.particles.size(), 0);
  ASSERT_EQ(slabs.begin.back(), static_cast<int>(slabs.order.size()));
  for (std::size_t s = 0; s + 1 < slabs.begin.size(); ++s)
    for (int at = slabs.begin[s]; at < slabs.begin[s + 1]; ++at) {
      const int p = slabs.order[static_cast<std::size_t>(at)];
      ++seen[static_cast<std::size_t>(p)];
      const auto base = quadratic_base(body.grid.to_cells(body.particles[static_cast<std::size_t>(p)].position()));
      EXPECT_EQ(base[0] / SlabOrder::planes, static_cast<int>(s));
    }
  for (std::size_t p = 0; p < seen.size(); ++p) EXPECT_EQ(seen[p], p == 17 ? 0 : 1);
}

TEST(GridToParticle, TellsWhenAParticleLeavesItsSlab) {
  fixture::FreeBody body = random_block();
  for (Particle& p : body.particles) p.velocity = Vec3::Zero(), p.affine_velocity = Mat3::Zero();
  body.grid.clear();
  particle_to_grid(body.particles, body.slabs, body.mass, body.grid);
  body.grid.momentum_to_velocity();
  EXPECT_TRUE(grid_to_particle(body.grid, body.slabs, 1e-3, body.particles));
  for (std::size_t n = 0; n < body.grid.nodes().size(); ++n) body.grid.node(n)[0] = 2 * cell / 1e-3;
  EXPECT_FALSE(grid_to_particle(body.grid, body.slabs, 1e-3, body.particles));
}

TEST(Transfer, BitsDoNotDependOnTheNumberOfThreads) {
  const auto after = [](std::size_t threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    fixture::FreeBody body = random_block(3);
    for (int n = 0; n < 20; ++n) body.step(1e-4, fixture::elastic(fixture::rubber()));
    return body.particles;
  };
  const auto one = after(1), two = after(2);
  for (std::size_t n = 0; n < one.size(); ++n) {
    ASSERT_EQ(one[n].displacement, two[n].displacement);
    ASSERT_EQ(one[n].affine_velocity, two[n].affine_velocity);
  }
}

}  // namespace
