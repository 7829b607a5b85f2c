/// Every hard case, as `sunder validate --hard` runs it.
#include "pipeline/hard_cases.h"

#include <cstdio>
#include <ostream>

#include <gtest/gtest.h>

namespace sunder::validation {
void PrintTo(const Problem& problem, std::ostream* out) { *out << problem.title; }
}  // namespace sunder::validation

namespace sunder::pipeline {
namespace {

using validation::Problem;

/// Those that take seconds.
bool is_slow(const Problem& p) { return p.id == "S17" || p.id == "X7" || p.id == "X10"; }

std::vector<Problem> chosen(bool slow) {
  std::vector<Problem> list;
  for (const Problem& p : hard_cases())
    if (is_slow(p) == slow) list.push_back(p);
  return list;
}

void expect_held(const Problem& problem) {
  const validation::Outcome outcome = problem.run();
  EXPECT_FALSE(outcome.checks.empty());
  for (const validation::Check& check : outcome.checks)
    EXPECT_TRUE(check.passed()) << check.what << ": " << check.value;
}

class HardCase : public ::testing::TestWithParam<Problem> {};
TEST_P(HardCase, Holds) { expect_held(GetParam()); }
INSTANTIATE_TEST_SUITE_P(Cases, HardCase, ::testing::ValuesIn(chosen(false)), [](const auto& p) { return p.param.id; });

class SlowHardCase : public ::testing::TestWithParam<Problem> {};
TEST_P(SlowHardCase, Holds) { expect_held(GetParam()); }
INSTANTIATE_TEST_SUITE_P(Cases, SlowHardCase, ::testing::ValuesIn(chosen(true)),
                         [](const auto& p) { return p.param.id; });

}  // namespace
}  // namespace sunder::pipeline
