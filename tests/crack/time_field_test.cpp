/// The damage-time field and its gradient (validation problem C8).
#include "crack/time_field.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "core/random.h"

namespace sunder::crack {
namespace {

constexpr double h = 0.1;
constexpr double exact = 1e-12;  // relative: a linear field is in the space of the fit, only rounding is left
const Vec3 slope(3, -2, 0.7);

/// Points at jittered places of a lattice with `per_cell` of them along a cell, where `inside` holds.
template <typename Inside>
std::vector<Vec3> scattered(const Box& box, int per_cell, Inside&& inside, double jitter = 0.3) {
  std::vector<Vec3> points;
  const double spacing = h / per_cell;
  const Eigen::Vector3i n = (box.sizes() / spacing).array().round().cast<int>();
  for (int i = 0; i < n.x(); ++i)
    for (int j = 0; j < n.y(); ++j)
      for (int k = 0; k < n.z(); ++k) {
        Vec3 x = box.min() + spacing * Vec3(i + 0.5, j + 0.5, k + 0.5);
        const auto index = static_cast<std::uint64_t>((i * n.y() + j) * n.z() + k);
        for (int axis = 0; axis < 3; ++axis) x[axis] += jitter * spacing * (2 * random_unit(1, axis, index) - 1);
        if (inside(x)) points.push_back(x);
      }
  return points;
}

template <typename Time>
TimeField field_of(const std::vector<Vec3>& points, Time&& time, double spacing = h) {
  std::vector<double> times;
  for (const Vec3& x : points) times.push_back(time(x));
  return {points, times, spacing};
}

double linear(const Vec3& x) { return 5 + slope.dot(x); }
const Box cube(Vec3::Zero(), Vec3::Ones());

double slope_error(const TimeField& field, const Vec3& x) {
  const auto sample = field.at(x);
  return sample ? (sample->gradient - slope).norm() / slope.norm() : INFINITY;
}

TEST(TimeField, IsExactForLinearTimesOnFullStencils) {
  const TimeField field = field_of(scattered(cube, 2, [](const Vec3&) { return true; }), linear);
  for (std::uint64_t i = 0; i < 200; ++i) {
    const Vec3 x =
        Vec3(0.25, 0.25, 0.25) + 0.5 * Vec3(random_unit(2, 0, i), random_unit(2, 1, i), random_unit(2, 2, i));
    EXPECT_LT(slope_error(field, x), exact);
    EXPECT_NEAR(field.at(x)->time, linear(x), exact * linear(x));
  }
}

TEST(TimeField, IsExactForLinearTimesOnHalfStencils) {
  const TimeField field = field_of(scattered(cube, 2, [](const Vec3& x) { return x.x() < 0.5; }), linear);
  for (std::uint64_t i = 0; i < 100; ++i) {
    const Vec3 x(0.5, 0.2 + 0.6 * random_unit(3, 0, i), 0.2 + 0.6 * random_unit(3, 1, i));
    EXPECT_LT(slope_error(field, x), exact);
    const Vec3 corner(0.02 * random_unit(3, 2, i), 0.02 * random_unit(3, 3, i), 0.02 * random_unit(3, 4, i));
    EXPECT_LT(slope_error(field, corner), exact);
  }
}

// A sheet of a single layer of points: what can be known is the gradient in the sheet, and it is exact.
TEST(TimeField, IsExactInAFlatSheetOfPoints) {
  const Vec3 normal = Vec3(1, 2, 3).normalized();
  std::vector<Vec3> points = scattered(cube, 2, [](const Vec3&) { return true; });
  for (Vec3& x : points) x -= normal * normal.dot(x - Vec3(0.5, 0.5, 0.5));
  const TimeField field = field_of(points, linear);
  const Vec3 in_sheet = slope - normal * normal.dot(slope);
  for (std::uint64_t i = 0; i < 100; ++i) {
    Vec3 x = Vec3(0.4, 0.4, 0.4) + 0.2 * Vec3(random_unit(4, 0, i), random_unit(4, 1, i), random_unit(4, 2, i));
    x -= normal * normal.dot(x - Vec3(0.5, 0.5, 0.5));
    const auto sample = field.at(x);
    ASSERT_TRUE(sample);
    // Rounding of the covariance, whose smallest eigenvalue stands for nothing, turns the plane a little.
    EXPECT_LT((sample->gradient - in_sheet).norm(), 1e-10 * in_sheet.norm());
  }
}

TEST(TimeField, PointsRadiallyForRadialTimes) {
  const Vec3 source(0.05, 0.03, 0.08);
  const auto radius = [&](const Vec3& x) { return (x - source).norm(); };
  const TimeField field =
      field_of(scattered(Box(Vec3::Zero(), Vec3::Constant(1.5)), 2, [](const Vec3&) { return true; }), radius);
  const double two_degrees = 2 * std::numbers::pi / 180;
  for (std::uint64_t i = 0; i < 500; ++i) {
    const Vec3 x =
        Vec3::Constant(2 * h) + (1.5 - 4 * h) * Vec3(random_unit(5, 0, i), random_unit(5, 1, i), random_unit(5, 2, i));
    if (radius(x) < 5 * h) continue;
    const auto sample = field.at(x);
    ASSERT_TRUE(sample);
    EXPECT_LT(std::acos(std::min(1.0, sample->gradient.normalized().dot((x - source).normalized()))), two_degrees);
  }
}

TEST(TimeField, KnowsNothingWhereNothingWasDamaged) {
  std::vector<Vec3> points = scattered(cube, 2, [](const Vec3&) { return true; });
  const TimeField none = field_of(points, [](const Vec3&) { return -1.0; });
  EXPECT_TRUE(none.empty());
  EXPECT_FALSE(none.at(Vec3(0.5, 0.5, 0.5)));
  const TimeField half = field_of(points, [](const Vec3& x) { return x.x() < 0.5 ? x.y() : -1.0; });
  EXPECT_TRUE(half.at(Vec3(0.4, 0.5, 0.5)));
  EXPECT_FALSE(half.at(Vec3(0.8, 0.5, 0.5)));
}

// On a line of nodes the direction across is open: that is not half known, but unknown.
TEST(TimeField, KnowsNothingBesideALineOfPoints) {
  std::vector<Vec3> points;
  for (int i = 0; i < 40; ++i) points.emplace_back(0.025 * i, 0.5, 0.5);
  const TimeField field = field_of(points, linear);
  EXPECT_FALSE(field.at(Vec3(0.5, 0.5, 0.5)));
}

}  // namespace
}  // namespace sunder::crack
