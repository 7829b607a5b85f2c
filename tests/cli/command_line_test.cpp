/// The exit codes that README.md promises.
#include "cli/command_line.h"

#include <filesystem>
#include <fstream>
#include <set>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace sunder::cli {
namespace {

namespace fs = std::filesystem;

struct Outcome {
  int code;
  std::string out, err;
};

Outcome sunder(std::vector<std::string> words) {
  words.insert(words.begin(), "sunder");
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  const int code = command_line(static_cast<int>(argv.size()), argv.data());
  return {code, testing::internal::GetCapturedStdout(), testing::internal::GetCapturedStderr()};
}

class CommandLine : public testing::Test {
 protected:
  void SetUp() override { fs::create_directories(folder_); }
  void TearDown() override { fs::remove_all(folder_); }

  std::string file(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name) << text;
    return (folder_ / name).string();
  }

  const fs::path folder_ = fs::path(testing::TempDir()) / ("sunder_command_line_" + std::to_string(getpid()));
  const std::string body_ = "[[body]]\nname = \"x\"\nmaterial = \"glass\"\nheight = 0.1\nmesh = ";
};

TEST_F(CommandLine, WrongUsageIsTwo) {
  EXPECT_EQ(sunder({}).code, 2);
  EXPECT_EQ(sunder({"rum", "a.toml"}).code, 2);
  EXPECT_EQ(sunder({"run"}).code, 2);
  EXPECT_EQ(sunder({"run", "a.toml", "--quality", "superb"}).code, 2);
  EXPECT_EQ(sunder({"run", "a.toml", "--threads", "0"}).code, 2);
  EXPECT_EQ(sunder({"run", (folder_ / "none.toml").string()}).code, 2);
}

TEST_F(CommandLine, AMistakeInTheSceneIsTwoAndNamesTheLine) {
  const Outcome outcome =
      sunder({"run", file("typo.toml", body_ + "\"cup\"\nvelocty = [0, 0, 0]\n"), "--out", (folder_ / "out").string()});
  EXPECT_EQ(outcome.code, 2);
  EXPECT_NE(outcome.err.find("typo.toml:6"), std::string::npos) << outcome.err;
  EXPECT_NE(outcome.err.find("'velocity'"), std::string::npos) << outcome.err;
  EXPECT_FALSE(fs::exists(folder_ / "out" / "report.json"));
}

TEST_F(CommandLine, AMeshThatCannotBeUsedIsThreeAndNamesTheDefect) {
  file("sheet.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  const Outcome outcome =
      sunder({"run", file("sheet.toml", body_ + "\"sheet.obj\"\n"), "--out", (folder_ / "out").string()});
  EXPECT_EQ(outcome.code, 3) << outcome.err;
  EXPECT_NE(outcome.err.find("boundary edge"), std::string::npos) << outcome.err;
  EXPECT_EQ(sunder({"inspect", (folder_ / "sheet.obj").string()}).code, 3);
  EXPECT_EQ(sunder({"check", (folder_ / "sheet.toml").string()}).code, 3);
}

TEST_F(CommandLine, AFileThatCannotBeReadIsFive) {
  EXPECT_EQ(sunder({"inspect", (folder_ / "none.obj").string()}).code, 5);
}

TEST_F(CommandLine, JsonErrorsCarryTheCode) {
  const Outcome outcome = sunder({"run", (folder_ / "none.toml").string(), "--log", "json"});
  EXPECT_NE(outcome.out.find("\"code\":2"), std::string::npos) << outcome.out;
}

TEST_F(CommandLine, OpenJobDescriptionHearsOfFailures) {
  const Outcome outcome = sunder({"run", (folder_ / "none.toml").string(), "--progress", "openjd"});
  EXPECT_EQ(outcome.code, 2);
  EXPECT_TRUE(outcome.out.starts_with("openjd_fail: ")) << outcome.out;
}

TEST_F(CommandLine, RangesOfFramesAreChecked) {
  const std::string scene =
      file("short.toml", "[scene]\nduration = 0.1\nframe_rate = 50\nstart_frame = 1001\n" + body_ + "\"cup\"\n");
  for (const char* wrong : {"0", "1001-1007", "1003-1002", "1-", "a", "1001-1002x2"}) {
    const Outcome outcome = sunder({"run", scene, "--frames", wrong, "--out", (folder_ / "out").string()});
    EXPECT_EQ(outcome.code, 2) << wrong;
    EXPECT_NE(outcome.err.find("1001-1006"), std::string::npos) << outcome.err;
  }
  ASSERT_EQ(sunder({"run", scene, "--frames", "1003-1004", "--out", (folder_ / "out").string()}).code, 0);
  std::set<std::string> frames;
  for (const auto& entry : fs::directory_iterator(folder_ / "out"))
    if (entry.path().extension() == ".obj") frames.insert(entry.path().filename());
  EXPECT_EQ(frames, (std::set<std::string>{"short.1003.obj", "short.1004.obj"}));
}

TEST_F(CommandLine, ADryRunChecksEverythingAndWritesNothing) {
  const std::string scene = file("short.toml", "[scene]\nduration = 0.1\nframe_rate = 50\n" + body_ + "\"cup\"\n");
  const fs::path out = folder_ / "new" / "out";
  const Outcome outcome = sunder({"run", scene, "--dry-run", "--out", out.string()});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_NE(outcome.out.find("short.####.obj, 6 files"), std::string::npos) << outcome.out;
  EXPECT_FALSE(fs::exists(folder_ / "new"));
  const auto json =
      nlohmann::json::parse(sunder({"run", scene, "--dry-run", "--log", "json", "--out", out.string()}).out);
  EXPECT_EQ(json["last_frame"], 6);
  EXPECT_EQ(sunder({"run", scene, "--dry-run", "--out", file("occupied", "")}).code, 5);
  EXPECT_EQ(sunder({"run", scene, "--out", (folder_ / "occupied").string()}).code, 5);
}

TEST_F(CommandLine, AValidSceneChecksAndRuns) {
  const std::string scene = file("still.toml", "[scene]\nduration = 0.1\n" + body_ + "\"cup\"\n");
  const Outcome checked = sunder({"check", scene});
  EXPECT_EQ(checked.code, 0);
  EXPECT_NE(checked.out.find("\ntwo_velocity_fields  auto skipped  the quality is below final\n"), std::string::npos)
      << checked.out;
  const Outcome json = sunder({"check", scene, "--json", "--quality", "final"});
  EXPECT_EQ(json.code, 0);
  EXPECT_NE(json.out.find("\"name\": \"two_velocity_fields\""), std::string::npos) << json.out;
  EXPECT_NE(json.out.find("\"why\": \"the quality is final\""), std::string::npos) << json.out;
  const Outcome outcome =
      sunder({"run", scene, "--out", (folder_ / "out").string(), "--quality", "draft", "--seed", "3"});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_TRUE(fs::exists(folder_ / "out" / "still.0001.obj"));
  EXPECT_TRUE(fs::exists(folder_ / "out" / "report.json"));
}

TEST_F(CommandLine, AnUnknownValidationProblemIsTwoAndNamesTheKnownOnes) {
  const Outcome outcome = sunder({"validate", "--only", "B2", "Z9"});
  EXPECT_EQ(outcome.code, 2);
  EXPECT_NE(outcome.err.find("'Z9'"), std::string::npos) << outcome.err;
  EXPECT_NE(outcome.err.find("A1, A2"), std::string::npos) << outcome.err;
}

TEST_F(CommandLine, AValidationProblemRunsAndWritesJson) {
  const fs::path json = folder_ / "validation.json";
  const Outcome outcome = sunder({"validate", "--only", "B2", "--json", json.string()});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_NE(outcome.out.find("B2"), std::string::npos) << outcome.out;
  std::ifstream in(json);
  const std::string text((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>());
  for (const char* key : {"\"problems\"", "\"id\": \"B2\"", "\"title\"", "\"source\"", "\"verdict\": \"pass\"",
                          "\"seconds\"", "\"particle_steps\"", "\"checks\"", "\"bound\""})
    EXPECT_NE(text.find(key), std::string::npos) << key << " in " << text;
  EXPECT_EQ(text.find("\"id\": \"B1\""), std::string::npos);
}

}  // namespace
}  // namespace sunder::cli
