#include "pipeline/accuracy.h"

#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/output/scratch_folder.h"

namespace sunder::pipeline {
namespace {

std::string pane(const char* speed) {
  return std::string(R"([scene]
duration = 0.1
quality = "draft"
[[body]]
name = "pane"
mesh = "box"
size = [0.1, 0.01, 0.1]
position = [0, 0.0005, 0]
material = "glass"
[ground]
[[body]]
name = "ball"
mesh = "sphere"
size = [0.02, 0.02, 0.02]
anchor = "centre"
position = [0, 0.025, 0]
material = "steel"
velocity = [0, )")
      .append(speed)
      .append(", 0]\n");
}

class AccuracyTest : public testing::Test {
 protected:
  std::filesystem::path scene(const std::string& text) const {
    std::ofstream(folder_ / "pane.toml") << text;
    return folder_ / "pane.toml";
  }
  void measure(const AccuracyOptions& options) {
    testing::internal::CaptureStdout();
    SilentProgress progress;
    try {
      measure_accuracy(options, progress);
    } catch (...) {
      out_ = testing::internal::GetCapturedStdout();
      throw;
    }
    out_ = testing::internal::GetCapturedStdout();
  }
  ErrorKind refusal(const AccuracyOptions& options) {
    try {
      measure(options);
    } catch (const Error& error) {
      return error.kind();
    }
    return ErrorKind::internal;
  }
  output::ScratchFolder folder_;
  std::string out_;
};
class AccuracySlowTest : public AccuracyTest {};

TEST_F(AccuracySlowTest, ComparesALadderWithItsFinest) {
  measure({.scene = scene(pane("-15")), .out = folder_ / "out", .most_particles = 20000, .seeds = 2});
  const auto json = nlohmann::json::parse(output::read_all(folder_ / "out/accuracy.json"));
  ASSERT_EQ(json.at("hits").size(), 1u);
  const auto& hit = json["hits"][0];
  EXPECT_EQ(hit.at("body"), "pane");
  const auto& rungs = hit.at("rungs");
  // 20000, 10000, and 5000 with two seeds, cubic splines and two velocity fields.
  ASSERT_EQ(rungs.size(), 6u);
  EXPECT_EQ(rungs[0]["particles"], 20000);
  EXPECT_EQ(rungs[0]["to_finest"]["damage"], 0);
  for (std::size_t n = 1; n < rungs.size(); ++n) {
    EXPECT_GT(rungs[n]["to_finest"]["damage"], 0);
    EXPECT_LT(rungs[n]["processor_seconds"], rungs[0]["processor_seconds"]);
  }
  EXPECT_EQ(hit.at("findings").size(), hit.at("convergence").size());
  EXPECT_TRUE(std::filesystem::exists(folder_ / "out/accuracy.html"));
  EXPECT_TRUE(std::filesystem::exists(folder_ / "out/crack_1_5000.png"));
  EXPECT_NE(out_.find("between seeds"), std::string::npos) << out_;
}

TEST_F(AccuracyTest, RefusesWhatBreaksNothingAndShortLadders) {
  EXPECT_EQ(refusal({.scene = scene(pane("-0.001")), .out = folder_ / "out", .most_particles = 20000}),
            ErrorKind::usage);
  EXPECT_EQ(refusal({.scene = scene(pane("-15")), .out = folder_ / "out", .most_particles = 10000}), ErrorKind::usage);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "out/accuracy.json"));
}

}  // namespace
}  // namespace sunder::pipeline
