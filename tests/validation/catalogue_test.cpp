/// Every problem of the catalogue, as `sunder validate` runs it.
#include <chrono>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <map>
#include <ostream>
#include <set>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "pipeline/hard_cases.h"
#include "validation/study.h"

namespace sunder::validation {
void PrintTo(const Problem& problem, std::ostream* out) { *out << problem.title; }
}  // namespace sunder::validation

namespace {

using sunder::validation::Problem;

/// Errors that were measured on another machine, by problem and check; empty without them.
std::map<std::string, double> committed_errors(const std::string& id) {
  std::map<std::string, double> errors;
  std::ifstream in(SUNDER_SOURCE_DIR "/docs/measured/catalogue.json");
  const auto json = nlohmann::json::parse(in);
  for (const auto& problem : json.at("problems"))
    if (problem.at("id") == id)
      for (const auto& check : problem.at("checks"))
        if (check.at("error").is_number()) errors[check.at("what")] = check.at("error");
  return errors;
}

/// Of the bound: what instruction sets and roundings, which cracks amplify, may move an error by.
constexpr double spread = 0.25;

void expect_held(const Problem& problem) {
  const auto start = std::chrono::steady_clock::now();
  const auto outcome = problem.run();
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
  const auto committed = committed_errors(problem.id);
  std::printf("%s: %s, %.1f s\n", problem.id.c_str(), problem.title.c_str(), seconds.count());
  for (const auto& check : outcome.checks) {
    std::printf("  %-60s %12.6g, reference %12.6g, error %9.3g <= %9.3g\n", check.what.c_str(), check.value,
                check.reference, check.error, check.bound);
    EXPECT_TRUE(check.passed()) << check.what;
    ASSERT_TRUE(committed.contains(check.what)) << check.what << ": docs/measured is of another catalogue";
    EXPECT_NEAR(check.error, committed.at(check.what), spread * check.bound) << check.what;
  }
  EXPECT_FALSE(outcome.checks.empty());
}

std::vector<Problem> studied() {
  std::vector<Problem> list;
  for (const Problem& p : sunder::pipeline::catalogue())
    if (p.study) list.push_back(p);
  return list;
}

class SlowStudy : public ::testing::TestWithParam<Problem> {};

TEST_P(SlowStudy, ErrorFallsAsWanted) {
  const auto result = sunder::validation::measure(*GetParam().study);
  for (const auto& m : result.points) {
    EXPECT_TRUE(std::isfinite(m.error)) << m.resolution;
    EXPECT_GT(m.seconds, 0);
  }
  EXPECT_TRUE(result.passed) << "order " << result.order;
}

INSTANTIATE_TEST_SUITE_P(Problems, SlowStudy, ::testing::ValuesIn(studied()), [](const auto& p) { return p.param.id; });

TEST(Study, FitsPowers) {
  using sunder::validation::power_of;
  // The slope of an exact power is its exponent, up to rounding.
  EXPECT_NEAR(power_of({1, 2, 4}, {3, 12, 48}), 2, 1e-12);
  EXPECT_NEAR(power_of({10, 30, 70}, {1.0 / 10, 1.0 / 30, 1.0 / 70}), -1, 1e-12);
  EXPECT_TRUE(std::isnan(power_of({4}, {1}))) << "one point has no slope";
  EXPECT_TRUE(std::isnan(power_of({1, 2}, {0, 1})));
}

TEST(Study, OrderThatIsTooLowFails) {
  const auto first_order = [](int n) { return sunder::validation::StudyPoint{1.0 / n, 0}; };
  EXPECT_TRUE(measure(sunder::validation::Study{"e", "n", {4, 8, 16}, 0.9, first_order}).passed);
  EXPECT_FALSE(measure(sunder::validation::Study{"e", "n", {4, 8, 16}, 1.1, first_order}).passed);
  EXPECT_TRUE(measure(sunder::validation::Study{"e", "n", {4, 8, 16}, {}, first_order}).passed);
}

/// Those that take more than some seconds.
std::vector<Problem> chosen(bool slow) {
  const std::set<std::string> long_ones = {"B5", "B9", "B11", "B15", "C7"};
  std::vector<Problem> list;
  for (const Problem& p : sunder::pipeline::catalogue())
    if (long_ones.contains(p.id) == slow) list.push_back(p);
  return list;
}

class Catalogue : public ::testing::TestWithParam<Problem> {};
TEST_P(Catalogue, Holds) { expect_held(GetParam()); }
INSTANTIATE_TEST_SUITE_P(Problems, Catalogue, ::testing::ValuesIn(chosen(false)),
                         [](const auto& p) { return p.param.id; });

class SlowCatalogue : public ::testing::TestWithParam<Problem> {};
TEST_P(SlowCatalogue, Holds) { expect_held(GetParam()); }
INSTANTIATE_TEST_SUITE_P(Problems, SlowCatalogue, ::testing::ValuesIn(chosen(true)),
                         [](const auto& p) { return p.param.id; });

}  // namespace
