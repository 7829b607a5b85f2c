/// Estimators on samples of known laws, and against numbers computed by hand.
#include "statistics/laws.h"

#include <numeric>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "tests/statistics/samples.h"

namespace sunder::statistics {
namespace {

class LawsTest : public testing::TestWithParam<Law> {};

INSTANTIATE_TEST_SUITE_P(AllLaws, LawsTest, testing::ValuesIn(kLaws),
                         [](const auto& law) { return std::string(name_of(law.param)); });

/// 10000 values: the standard deviation of location^ is at most 1.3 scale / 100 and of scale^ at most scale / 100 for
/// all laws, so five of them.
TEST_P(LawsTest, EstimatesConvergeToTheTruth) {
  const LogPlace truth = example_place(GetParam());
  const LogPlace found = most_likely(GetParam(), logarithms_of(sample_of(GetParam(), truth, 10000, 1)));
  EXPECT_NEAR(found.location, truth.location, 0.065 * truth.scale);
  EXPECT_NEAR(found.scale, truth.scale, 0.05 * truth.scale);
}

/// No place near the estimate is likelier, for samples of any law, not only its own.
TEST_P(LawsTest, NothingNearbyIsLikelier) {
  for (const Law drawn : kLaws) {
    const std::vector<double> logs = logarithms_of(sample_of(drawn, example_place(drawn), 200, 2));
    const LogPlace best = most_likely(GetParam(), logs);
    const double likelihood = log_likelihood(GetParam(), best, logs);
    for (const double step : {-1e-3, 1e-3}) {
      EXPECT_LT(log_likelihood(GetParam(), {best.location + step * best.scale, best.scale}, logs), likelihood);
      if (fixed_scale(GetParam())) continue;
      EXPECT_LT(log_likelihood(GetParam(), {best.location, best.scale * (1 + step)}, logs), likelihood);
    }
  }
}

/// The density is the slope of the distribution: central differences of width 2e-5 are good to 1e-9.
TEST_P(LawsTest, DensityBelongsToDistribution) {
  constexpr double h = 1e-5;
  for (const double z : {-3.0, -1.0, -0.1}) {
    const double slope = (standard_cdf(GetParam(), z + h) - standard_cdf(GetParam(), z - h)) / (2 * h);
    EXPECT_NEAR(std::exp(standard_log_density(GetParam(), z)), slope, 1e-8);
  }
}

/// KS distance of 10000 values from their own law is above 1.95 / 100 once in a thousand times (Kolmogorov 1933).
TEST_P(LawsTest, SamplesFollowTheirLawInOrder) {
  const std::vector<double> sample = standard_sample(GetParam(), 10000, 5, 3);
  EXPECT_TRUE(std::is_sorted(sample.begin(), sample.end()));
  EXPECT_LT(ks_distance(GetParam(), {0, 1}, sample), 0.0195);
  EXPECT_EQ(sample, standard_sample(GetParam(), 10000, 5, 3));
  EXPECT_NE(sample, standard_sample(GetParam(), 10000, 5, 4));
}

/// What makes the intervals exact: estimates move and stretch with the data, KS distances stay. Rounding of sums only.
TEST_P(LawsTest, EstimatesMoveWithTheData) {
  rc::check([law = GetParam()] {
    const double shift = *rc::gen::inRange(-2000, 2000) / 100.0;
    const double stretch = fixed_scale(law) ? 1 : *rc::gen::inRange(1, 400) / 100.0;
    const auto count = static_cast<std::size_t>(*rc::gen::inRange(2, 300));
    const std::vector<double> sample = standard_sample(law, count, 8, *rc::gen::arbitrary<std::uint32_t>());
    std::vector<double> moved = sample;
    for (double& y : moved) y = shift + stretch * y;
    const LogPlace a = most_likely(law, sample), b = most_likely(law, moved);
    constexpr double kRounding = 1e-8;
    RC_ASSERT(std::abs(b.location - (shift + stretch * a.location)) <= kRounding * (1 + std::abs(shift) + stretch));
    RC_ASSERT(fixed_scale(law) || std::abs(b.scale - stretch * a.scale) <= kRounding * stretch);
    RC_ASSERT(std::abs(ks_distance(law, b, moved) - ks_distance(law, a, sample)) <= kRounding);
  });
}

TEST(Laws, ClosedFormsByHand) {
  const std::vector<double> logs = {std::log(1.0), std::log(4.0), std::log(9.0)};
  // Mean root 2, so mu = 4.
  EXPECT_NEAR(most_likely(Law::mott_2d, logs).location, std::log(4.0), 1e-14);
  // Mean third root (1 + 4^(1/3) + 9^(1/3)) / 3.
  EXPECT_NEAR(most_likely(Law::mott_3d, logs).location, 3 * std::log((1 + std::cbrt(4.0) + std::cbrt(9.0)) / 3), 1e-14);
  const LogPlace gaudin = most_likely(Law::gaudin_schuhmann, logs);
  EXPECT_EQ(gaudin.location, std::log(9.0));
  EXPECT_NEAR(gaudin.scale, (std::log(9.0) + std::log(9.0 / 4)) / 3, 1e-14);
  const LogPlace normal = most_likely(Law::log_normal, logs);
  EXPECT_NEAR(normal.location, std::log(36.0) / 3, 1e-14);
}

TEST(Laws, MottsSharesAreThoseOfThePaper) {
  // P(x > mu) = 1/e; P(x > 4 mu) = exp(-2) in two and exp(-4^(1/3)) in three dimensions.
  EXPECT_NEAR(1 - standard_cdf(Law::mott_2d, std::log(4.0) / 2), std::exp(-2), 1e-14);
  EXPECT_NEAR(1 - standard_cdf(Law::mott_3d, std::log(4.0) / 3), std::exp(-std::cbrt(4.0)), 1e-14);
}

TEST(Laws, DistanceByHandAndWithTies) {
  // Under the law of density 1 on ln x < 0 ... F = x / maximum for exponent 1: F(0.2) = 0.2, F(0.5) = 0.5.
  const LogPlace uniform{0, 1};
  EXPECT_NEAR(ks_distance(Law::gaudin_schuhmann, uniform, std::vector{std::log(0.2), std::log(0.5)}), 0.5, 1e-15);
  // The share jumps from 0 to 3/4 at 0.5.
  const double tie = std::log(0.5);
  EXPECT_NEAR(ks_distance(Law::gaudin_schuhmann, uniform, std::vector{tie, tie, tie, std::log(0.9)}), 0.5, 1e-15);
}

}  // namespace
}  // namespace sunder::statistics
