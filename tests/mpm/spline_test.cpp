#include "mpm/spline.h"

#include <gtest/gtest.h>

#include "core/random.h"
#include "tests/mpm/reference_step.h"

namespace {

using namespace sunder;
using namespace sunder::mpm;

/// Sums of at most 64 terms of order one.
constexpr double rounding = 1e-13;

class SplineWeights : public ::testing::TestWithParam<Spline> {};

// Problem A3.
TEST_P(SplineWeights, MomentsAreThoseOfTheSpline) {
  const Spline spline = GetParam();
  const double lowest = stencil_shift(spline) - 1;
  for (std::uint64_t n = 0; n < 10000; ++n) {
    const double o = lowest + random_unit(7, 0, n);
    double w[4];
    spline_weights(spline, o, w);
    double sum = 0, first = 0, second = 0;
    for (int k = 0; k < 4; ++k) {
      EXPECT_GE(w[k], 0);
      sum += w[k];
      first += w[k] * (k - 1 - o);
      second += w[k] * (k - 1 - o) * (k - 1 - o);
    }
    EXPECT_NEAR(sum, 1, rounding);
    EXPECT_NEAR(first, 0, rounding);
    EXPECT_NEAR(second, spline_moment(spline), rounding);
  }
}

TEST_P(SplineWeights, AreTheSplineAtTheNodes) {
  const Spline spline = GetParam();
  const double lowest = stencil_shift(spline) - 1;
  for (int n = 0; n < 100; ++n) {
    const double o = lowest + 0.01 * n;
    double w[4];
    spline_weights(spline, o, w);
    for (int k = 0; k < 4; ++k)
      EXPECT_NEAR(w[k], k < stencil_width(spline) ? fixture::kernel(spline, k - 1 - o) : 0, rounding);
  }
}

INSTANTIATE_TEST_SUITE_P(Splines, SplineWeights, ::testing::Values(Spline::quadratic, Spline::cubic),
                         [](const auto& p) { return p.param == Spline::quadratic ? "quadratic" : "cubic"; });

}  // namespace
