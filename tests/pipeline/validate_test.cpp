#include "pipeline/validate.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "pipeline/hard_cases.h"
#include "tests/output/scratch_folder.h"

namespace sunder::pipeline {
namespace {

class ValidateTest : public testing::Test {
 protected:
  bool run(const ValidateOptions& options) {
    testing::internal::CaptureStdout();
    SilentProgress progress;
    bool passed = false;
    try {
      passed = validate(options, progress);
    } catch (...) {
      out_ = testing::internal::GetCapturedStdout();
      throw;
    }
    out_ = testing::internal::GetCapturedStdout();
    return passed;
  }
  std::string refusal(const ValidateOptions& options) {
    try {
      run(options);
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::usage);
      return error.what();
    }
    return {};
  }

  output::ScratchFolder folder_;
  std::string out_;
};

TEST_F(ValidateTest, WritesWhatItMeasured) {
  EXPECT_TRUE(
      run({.only = {"A5", "A3"}, .json = folder_ / "v.json", .svg = folder_ / "v.svg", .html = folder_ / "v.html"}));
  const auto json = nlohmann::json::parse(output::read_all(folder_ / "v.json"));
  ASSERT_EQ(json.at("problems").size(), 2u);
  EXPECT_EQ(json["problems"][0]["id"], "A3") << "in the order of the catalogue";
  const auto& bar = json["problems"][1];
  for (const char* key : {"error", "bound", "seconds", "processor_seconds", "particle_steps", "memory_mb"})
    EXPECT_TRUE(bar.at(key).is_number()) << key;
  EXPECT_EQ(bar.at("verdict"), "pass");
  EXPECT_LE(bar.at("error"), bar.at("bound"));
  // First order, see validation/vibration.cpp.
  EXPECT_NEAR(bar.at("order").get<double>(), 1, 0.3);
  EXPECT_GT(bar.at("cost_exponent").get<double>(), 0);
  EXPECT_EQ(bar.at("study").at("points").size(), 3u);
  EXPECT_TRUE(json["problems"][0]["study"].is_null());
  EXPECT_TRUE(json.at("machine").at("processor").is_string());
  EXPECT_NE(output::read_all(folder_ / "v.html").find("<svg"), std::string::npos);
  EXPECT_NE(output::read_all(folder_ / "v.svg").find("A5"), std::string::npos);
  EXPECT_NE(out_.find("to halve the error costs"), std::string::npos) << out_;
}

TEST_F(ValidateTest, StudiesAtOtherResolutions) {
  EXPECT_TRUE(run({.only = {"A5"}, .resolutions = {8, 16}, .json = folder_ / "v.json"}));
  const auto json = nlohmann::json::parse(output::read_all(folder_ / "v.json"));
  EXPECT_EQ(json["problems"][0]["study"]["points"][0]["resolution"], 8);
}

TEST_F(ValidateTest, RefusesWhatCannotBe) {
  EXPECT_NE(refusal({.only = {"Z9"}}).find("known: A1"), std::string::npos);
  EXPECT_NE(refusal({.resolutions = {8, 16}}).find("--only"), std::string::npos);
  EXPECT_NE(refusal({.only = {"A3"}, .resolutions = {8}}).find("A5"), std::string::npos) << "names those that have one";
  EXPECT_NE(refusal({.hard = true, .only = {"A3"}}).find("hard case"), std::string::npos);
}

TEST_F(ValidateTest, HardCasesAreACatalogueOfTheirOwn) {
  EXPECT_TRUE(run({.hard = true, .only = {"S9"}, .json = folder_ / "v.json"}));
  EXPECT_NE(out_.find("refused, \"approach_speed must be positive\""), std::string::npos) << out_;
  EXPECT_GE(hard_cases().size(), 20u);
}

}  // namespace
}  // namespace sunder::pipeline
