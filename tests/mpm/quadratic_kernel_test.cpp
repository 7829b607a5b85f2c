#include "mpm/quadratic_kernel.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "core/random.h"
#include "tests/mpm/reference_step.h"

namespace {

using namespace sunder;
using namespace sunder::mpm;

/// Sums of 27 terms of order one.
constexpr double rounding = 1e-13;
/// The same of positions near 50 cells from the origin, where a coordinate itself is known to 1e-14 only.
constexpr double far_rounding = 1e-12;

Vec3 random_point(std::uint64_t n) {
  return 100 * Vec3(random_unit(7, 0, n), random_unit(7, 1, n), random_unit(7, 2, n)) - Vec3::Constant(50);
}

template <class Visit>
void for_each_node(const QuadraticStencil& s, const Visit& visit) {
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      for (int k = 0; k < 3; ++k) {
        const auto at = [](int n) { return static_cast<std::size_t>(n); };
        visit(s.weight[0][at(i)] * s.weight[1][at(j)] * s.weight[2][at(k)],
              Vec3(i - s.offset[0], j - s.offset[1], k - s.offset[2]));
      }
}

// Problem A3.
TEST(QuadraticStencil, MomentsAreThoseOfTheSpline) {
  for (std::uint64_t n = 0; n < 10000; ++n) {
    double sum = 0;
    Vec3 first = Vec3::Zero();
    Mat3 second = Mat3::Zero();
    for_each_node(quadratic_stencil(random_point(n)), [&](double w, const Vec3& d) {
      sum += w;
      first += w * d;
      second += w * d * d.transpose();
    });
    ASSERT_NEAR(sum, 1, rounding);
    ASSERT_LT(first.norm(), rounding);
    ASSERT_LT((second - quadratic_moment * Mat3::Identity()).norm(), rounding);
  }
}

TEST(QuadraticStencil, IsTheKernelOfTheDistance) {
  for (std::uint64_t n = 0; n < 1000; ++n) {
    const Vec3 x = random_point(n);
    for_each_node(quadratic_stencil(x), [&](double w, const Vec3& d) {
      EXPECT_NEAR(w, fixture::kernel(d[0]) * fixture::kernel(d[1]) * fixture::kernel(d[2]), far_rounding);
      EXPECT_GE(w, 0);
    });
  }
}

TEST(QuadraticStencil, BaseAndOffsetPointAtTheParticle) {
  for (double x : {0.0, 0.49999, 0.5, 0.50001, 1.0, -0.5, -3.7, 1.5}) {
    const QuadraticStencil s = quadratic_stencil(Vec3::Constant(x));
    EXPECT_EQ(s.base, quadratic_base(Vec3::Constant(x)));
    EXPECT_NEAR(s.base[0] + s.offset[0], x, rounding);
    EXPECT_GE(s.offset[0], 0.5);
    EXPECT_LT(s.offset[0], 1.5);
  }
}

TEST(QuadraticStencil, WeightsAreSmoothAcrossCells) {
  // C1: a step of 2e-9 over the change of cell moves a weight by at most its slope times that.
  const double step = 1e-9;
  const auto weight_of_node = [](double x, int node) {
    const QuadraticStencil s = quadratic_stencil({x, 1, 1});
    const int at = node - s.base[0];
    return at < 0 || at > 2 ? 0.0 : s.weight[0][static_cast<std::size_t>(at)];
  };
  for (int node = -2; node < 4; ++node)
    EXPECT_LT(std::abs(weight_of_node(0.5 + step, node) - weight_of_node(0.5 - step, node)), 2.1 * step);
}

RC_GTEST_PROP(QuadraticStencil, GradientOfALinearFieldIsExact, (std::array<int, 9> entries, std::array<int, 3> at)) {
  Mat3 g;
  for (int n = 0; n < 9; ++n) g(n / 3, n % 3) = (entries[static_cast<std::size_t>(n)] % 1000) * 1e-3;
  const Vec3 x(at[0] % 997 * 0.01, at[1] % 997 * 0.01, at[2] % 997 * 0.01);
  Mat3 c = Mat3::Zero();
  for_each_node(quadratic_stencil(x),
                [&](double w, const Vec3& d) { c += w / quadratic_moment * (g * (x + d)) * d.transpose(); });
  RC_ASSERT((c - g).norm() < 1e-12);
}

}  // namespace
