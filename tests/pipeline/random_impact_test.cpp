/// Where impactors from anywhere hit.
#include "pipeline/random_impact.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "core/error.h"
#include "geometry/primitives.h"
#include "geometry/surface_distance.h"

namespace sunder::pipeline {
namespace {

constexpr double right_angle = std::numbers::pi / 2;

TEST(RandomImpact, HitsASphereAsACosineLaw) {
  const geometry::TriangleMesh ball = geometry::sphere(0.1, 4);
  const int count = 1000;
  double mean = 0;
  Vec3 centre = Vec3::Zero();
  for (int seed = 0; seed < count; ++seed) {
    const ImpactPoint impact = random_impact(ball, right_angle, static_cast<std::uint64_t>(seed));
    EXPECT_NEAR(impact.at.norm(), 0.1, 2e-3) << "a facet lies a little inside";
    EXPECT_NEAR(impact.direction.norm(), 1, 1e-12);
    mean += -impact.direction.dot(impact.at.normalized()) / count;
    centre += impact.at / count;
  }
  // Of parallel flights evenly over a disk the mean cosine is 2/3, with a deviation of sqrt(1/18) for each.
  EXPECT_NEAR(mean, 2.0 / 3, 5 * std::sqrt(1.0 / 18 / count));
  EXPECT_LT(centre.norm(), 5 * 0.1 / std::sqrt(count)) << "from all sides";
}

RC_GTEST_PROP(RandomImpact, IsOnTheSurfaceSquareEnoughAndSeenFromOutside, (std::uint64_t seed)) {
  const geometry::TriangleMesh body = geometry::box(Vec3(0.1, 0.3, 0.02));
  const double angle = 0.6;
  const ImpactPoint impact = random_impact(body, angle, seed);
  const geometry::SurfacePoint nearest = geometry::nearest_on(body, {&impact.at, 1}).front();
  RC_ASSERT(nearest.distance < 1e-12);
  const Vec3 normal = geometry::face_normal(body, static_cast<std::size_t>(nearest.face));
  RC_ASSERT(-impact.direction.dot(normal) >= std::cos(angle) - 1e-12);
  const ImpactPoint again = random_impact(body, angle, seed);
  RC_ASSERT(again.at == impact.at && again.direction == impact.direction);
}

TEST(RandomImpact, WithoutASquareHitThereIsAnError) {
  const geometry::TriangleMesh flat = {{{0, 0, 0}, {1, 0, 0}, {0, 1e-12, 0}}, {{0, 1, 2}}};
  EXPECT_THROW(random_impact(flat, 1e-9, 1), Error);
}

}  // namespace
}  // namespace sunder::pipeline
