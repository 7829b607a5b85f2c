#include "mpm/strength_scatter.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "core/random.h"

namespace {

using namespace sunder;
using namespace sunder::mpm;

std::vector<Vec3> scattered_points(std::size_t count, double size) {
  std::vector<Vec3> points(count);
  for (std::size_t n = 0; n < count; ++n)
    points[n] = size * Vec3(random_unit(2, 0, n), random_unit(2, 1, n), random_unit(2, 2, n));
  return points;
}

TEST(StrengthScatter, ModulusZeroMeansNone) {
  for (double f : strength_scatter(scattered_points(10, 1), 0, 0.1, 1)) EXPECT_EQ(f, 1);
}

TEST(StrengthScatter, IsWeibullDistributedWithMeanOne) {
  constexpr double modulus = 8;
  // 20000 points in 1e6 correlation volumes are nearly independent: the Kolmogorov distance at 0.1 % is 1.95 / sqrt(n).
  auto factors = strength_scatter(scattered_points(20000, 100), modulus, 1, 3);
  std::sort(factors.begin(), factors.end());
  const double n = static_cast<double>(factors.size()), mean = std::tgamma(1 + 1 / modulus);
  double distance = 0, sum = 0;
  for (std::size_t k = 0; k < factors.size(); ++k) {
    const double expected = 1 - std::exp(-std::pow(factors[k] * mean, modulus));
    distance = std::max(distance, std::abs(expected - static_cast<double>(k) / n));
    sum += factors[k];
  }
  EXPECT_LT(distance, 1.95 / std::sqrt(n));
  EXPECT_NEAR(sum / n, 1, 0.01);
}

TEST(StrengthScatter, IsSmoothOverTheCorrelationLength) {
  const auto points = scattered_points(500, 10);
  auto moved = points;
  for (Vec3& x : moved) x += Vec3(1e-3, -1e-3, 1e-3);
  const auto here = strength_scatter(points, 8, 1, 3), there = strength_scatter(moved, 8, 1, 3);
  for (std::size_t n = 0; n < here.size(); ++n) EXPECT_NEAR(here[n], there[n], 0.02);
}

TEST(StrengthScatter, DependsOnSeedAndPositionOnly) {
  const auto points = scattered_points(100, 10);
  auto reversed = points;
  std::reverse(reversed.begin(), reversed.end());
  const auto forwards = strength_scatter(points, 8, 1, 3);
  auto backwards = strength_scatter(reversed, 8, 1, 3);
  std::reverse(backwards.begin(), backwards.end());
  EXPECT_EQ(forwards, backwards);
  EXPECT_NE(forwards, strength_scatter(points, 8, 1, 4));
}

TEST(StrengthScatter, FarTailsStayFiniteAndPositive) {
  for (double modulus : {0.5, 1.0, 50.0})
    for (double f : strength_scatter(scattered_points(2000, 100), modulus, 1, 9)) {
      EXPECT_TRUE(std::isfinite(f));
      EXPECT_GT(f, 0);
    }
}

}  // namespace
