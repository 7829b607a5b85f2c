/// The camera of stills.
#include "output/detail/camera.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "core/random.h"

namespace sunder::output::detail {
namespace {

constexpr double kRounding = 1e-9;  // of numbers of order one to a hundred

TEST(Camera, ProjectsAlongItsRays) {
  const Vec3 towards = backward(0.4, 0.3);
  const std::vector<Vec3> points = {{1, 2, 3}, {-1, 0, 0.5}};
  const Camera camera = fitted_camera(points, towards, {0.4, 0.2}, 0.8);
  EXPECT_LT((camera.axes * camera.axes.transpose() - Mat3::Identity()).norm(), kRounding);
  EXPECT_NEAR(camera.axes.determinant(), 1, kRounding);
  EXPECT_GT(camera.axes(1, 1), 0) << "up is up";
  for (const Eigen::Vector2d& picture : {Eigen::Vector2d(0, 0), Eigen::Vector2d(-1, 0.5), Eigen::Vector2d(0.3, -0.9)}) {
    const Vec3 point = camera.eye + 7 * camera.direction(picture);
    EXPECT_LT((camera.project(point) - picture).norm(), kRounding);
  }
}

TEST(Camera, AzimuthTurnsFromZToX) {
  EXPECT_LT((backward(0, 0) - Vec3::UnitZ()).norm(), kRounding);
  EXPECT_LT((backward(std::numbers::pi / 2, 0) - Vec3::UnitX()).norm(), kRounding);
  EXPECT_LT((backward(1, std::numbers::pi / 2) - Vec3::UnitY()).norm(), kRounding);
}

RC_GTEST_PROP(Camera, SeesAllPointsAsLargeAsItMay, (std::uint64_t seed)) {
  std::vector<Vec3> points;
  for (std::uint64_t i = 0; i < 20; ++i) {
    const auto number = [&](std::uint64_t k) { return 10 * random_unit(seed, k, i) - 5; };
    points.push_back({number(0), number(1), number(2)});
  }
  constexpr double kFill = 0.7;
  const Camera camera =
      fitted_camera(points, backward(6 * random_unit(seed, 3, 0), random_unit(seed, 4, 0)), {0.36, 0.2}, kFill);
  Eigen::Array2d low = Eigen::Array2d::Ones(), high = -low;
  for (const Vec3& point : points) {
    RC_ASSERT((camera.axes.transpose() * (point - camera.eye)).z() < 0);
    low = low.min(camera.project(point).array());
    high = high.max(camera.project(point).array());
  }
  RC_ASSERT((low >= -kFill - kRounding).all() && (high <= kFill + kRounding).all());
  const Eigen::Array2d touching = (low + kFill).abs().max((high - kFill).abs());
  RC_ASSERT(touching.minCoeff() < kRounding);
}

}  // namespace
}  // namespace sunder::output::detail
