/// Every problem of the catalogue, as `sunder validate` runs it.
#include <chrono>
#include <cstdio>
#include <ostream>

#include <gtest/gtest.h>

#include "validation/problem.h"

namespace sunder::validation {
void PrintTo(const Problem& problem, std::ostream* out) { *out << problem.title; }
}  // namespace sunder::validation

namespace {

using sunder::validation::Problem;

class Catalogue : public ::testing::TestWithParam<Problem> {};

TEST_P(Catalogue, Holds) {
  const auto start = std::chrono::steady_clock::now();
  const auto outcome = GetParam().run();
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
  std::printf("%s: %s, %.1f s\n", GetParam().id.c_str(), GetParam().title.c_str(), seconds.count());
  for (const auto& check : outcome.checks) {
    std::printf("  %-60s %12.6g, reference %12.6g, error %9.3g <= %9.3g\n", check.what.c_str(), check.value,
                check.reference, check.error, check.bound);
    EXPECT_TRUE(check.passed()) << check.what;
  }
  EXPECT_FALSE(outcome.checks.empty());
}

INSTANTIATE_TEST_SUITE_P(Problems, Catalogue, ::testing::ValuesIn(sunder::validation::problems()),
                         [](const auto& p) { return p.param.id; });

}  // namespace
