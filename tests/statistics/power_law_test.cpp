/// Where tails begin and how steep they are.
#include "statistics/power_law.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "core/random.h"
#include "tests/statistics/samples.h"

namespace sunder::statistics {
namespace {

/// ln x of a body that is uniform in ln x on [-2, 0) and a tail of density x^-exponent above 1, half of the values
/// each.
std::vector<double> body_and_tail(std::size_t count, double exponent, std::uint64_t stream) {
  std::vector<double> logs = exponential_sample(count / 2, 33, stream);
  for (double& y : logs) y /= exponent - 1;
  for (std::size_t k = count / 2; k < count; ++k) logs.push_back(2 * random_unit(34, stream, k) - 2);
  std::sort(logs.begin(), logs.end());
  return logs;
}

TEST(PowerLaw, FindsExponentAndBeginning) {
  // A tail that begins in the body is bent; one that begins above 1 is still a power law, so the choice may be late,
  // and is here by less than half of the 2000 values. Of 1000 values the exponent has a standard deviation of 1.5 /
  // sqrt(1000) = 0.047 (CSN eq. 3.2), four of them.
  const PowerLaw law = best_tail(body_and_tail(4000, 2.5, 1));
  EXPECT_NEAR(law.exponent, 2.5, 0.19);
  EXPECT_GT(law.log_above, -0.05);
  EXPECT_GT(law.count, 1000u);
}

TEST(PowerLaw, ExponentByHand) {
  const TailChoice three{.smallest_tail = 3};
  const PowerLaw law = best_tail(std::vector{0.0, 1.0, 2.0}, three);
  EXPECT_EQ(law.count, 3u);
  EXPECT_NEAR(law.exponent, 2, 1e-15);  // 1 + 3 / (0 + 1 + 2)
  // ln of the density is 0 - 1 y - ln x = -2 y.
  EXPECT_NEAR(log_likelihood(law, std::vector{0.0, 1.0, 2.0}), -6, 1e-14);
}

TEST(PowerLaw, ATailHoldsAllValuesThatEqualItsFirst) {
  std::vector<double> logs = {0, 0, 0, 0, 0, 0, 0, 0, 0.5, 1, 1.5};
  EXPECT_EQ(best_tail(logs).count, 11u);
}

TEST(PowerLaw, ValuesThatAreAllTheSameHaveNoTail) { EXPECT_EQ(best_tail(std::vector<double>(20, 1.0)).count, 0u); }

TEST(PowerLaw, FewCandidatesFindNearlyWhatAllFind) {
  const std::vector<double> logs = body_and_tail(1000, 2, 7);
  const PowerLaw all = best_tail(logs, {.most_candidates = 1000}), few = best_tail(logs);
  EXPECT_GE(few.ks, all.ks);
  // Two neighbouring candidates are a factor of 100^(1/59) = 1.08 apart in the length of the tail.
  EXPECT_LT(few.ks, all.ks + 0.08);
  EXPECT_NEAR(few.exponent, all.exponent, 0.1);
}

TEST(PowerLaw, ReplicasAreWhatTheLawSays) {
  const std::vector<double> logs = body_and_tail(4000, 2.5, 2);
  const PowerLaw law = best_tail(logs);
  const std::vector<double> again = replica(law, logs, 3, 4);
  ASSERT_EQ(again.size(), logs.size());
  EXPECT_TRUE(std::is_sorted(again.begin(), again.end()));
  const auto tail = std::lower_bound(again.begin(), again.end(), law.log_above);
  // Binomial: standard deviation at most sqrt(4000) / 2 = 32 values, four of them.
  EXPECT_NEAR(static_cast<double>(again.end() - tail), static_cast<double>(law.count), 130);
  for (auto y = again.begin(); y != tail; ++y) EXPECT_TRUE(std::binary_search(logs.begin(), logs.end(), *y));
  const PowerLaw found = best_tail(again);
  EXPECT_NEAR(found.exponent, law.exponent, 0.2);
}

}  // namespace
}  // namespace sunder::statistics
