/// A run that is stopped, by Ctrl-C or worse, goes on to the bytes of one that never was.
#include "pipeline/checkpoint.h"

#include <atomic>
#include <csignal>
#include <cstdlib>
#include <map>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <sys/wait.h>

#include "core/random.h"
#include "pipeline/fingerprint.h"
#include "pipeline/run.h"
#include "tests/output/scratch_folder.h"

namespace sunder::pipeline {
namespace {

namespace fs = std::filesystem;

/// A glass pane that breaks at once, on a driven table, whose pieces fall, break again and come to rest.
constexpr const char* pane = R"([scene]
duration = 0.3
frame_rate = 60
quality = 1500
[ground]
[[body]]
name = "pane"
mesh = "plate"
size = [0.2, 0.01, 0.2]
position = [0, 0.1, 0]
material = "glass"
[[body]]
name = "ball"
mesh = "sphere"
size = [0.02, 0.02, 0.02]
anchor = "centre"
position = [0.03, 0.13, 0.02]
velocity = [0, -10, 0]
material = "steel"
[[body]]
name = "table"
mesh = "box"
size = [0.05, 0.02, 0.05]
motion = "kinematic"
path = [{ time = 0, position = [0.2, 0.02, 0] }, { time = 0.2, position = [0, 0.02, 0], rotation = [0, 90, 0] }]
material = "steel"
[fracture]
refracture_delay = 0.01
[output]
poster = false
checkpoint_interval = 4
)";

/// Stops after so many questions whether it should.
class Stopping final : public Progress {
 public:
  explicit Stopping(int questions) : left_(questions) {}
  void report(std::string_view, double) override {}
  bool cancelled() const override { return left_.fetch_sub(1) <= 0; }
  int left() const { return left_; }

 private:
  mutable std::atomic<int> left_;
};

/// All files by name; of the report what does not measure time.
std::map<std::string, std::string> results(const fs::path& folder) {
  std::map<std::string, std::string> files;
  for (const auto& entry : fs::directory_iterator(folder))
    files[entry.path().filename()] = output::read_all(entry.path());
  auto report = nlohmann::json::parse(files.at("report.json"));
  for (const char* key : {"seconds", "peak_memory_mb", "threads", "prediction"}) report.erase(key);
  report["mpm"].erase("particle_steps_per_second");
  for (auto& fracture : report["fractures"]) fracture.erase("seconds");
  for (auto& effect : report["effects"]) effect.erase("seconds");
  files["report.json"] = report.dump();
  files.erase("index.html");  // shows the report, times included
  return files;
}

void expect_same(const std::map<std::string, std::string>& found, const std::map<std::string, std::string>& expected) {
  ASSERT_EQ(found.size(), expected.size());
  for (const auto& [name, bytes] : expected) {
    ASSERT_TRUE(found.contains(name)) << name;
    EXPECT_TRUE(found.at(name) == bytes) << name << (name == "report.json" ? found.at(name) + "\n" + bytes : "");
  }
}

class CheckpointTest : public testing::Test {
 protected:
  CheckpointTest() {
    std::ofstream(folder_ / "pane.toml") << pane;
    scene_ = load_scene(folder_ / "pane.toml");
  }

  RunResult go(const std::string& out, Progress& progress, bool resume = true) {
    return run(scene_, {.out = folder_ / out, .resume = resume}, progress);
  }

  output::ScratchFolder folder_;
  Scene scene_;
};

TEST_F(CheckpointTest, ARunStoppedAnywhereGoesOnToTheSameBytes) {
  Stopping never(1000000);
  const RunResult whole = go("whole", never);
  const int questions = 1000000 - never.left();
  ASSERT_GT(whole.sequence.pieces.size(), 8u);
  const auto expected = results(folder_ / "whole");
  constexpr int trials = 8;
  int stops = 0;
  for (std::uint64_t trial = 0; trial < trials; ++trial) {
    const std::string out = "stopped" + std::to_string(trial);
    for (std::uint64_t leg = 0;; ++leg) {
      Stopping progress(static_cast<int>(random_unit(1, trial, leg) * questions));
      if (!go(out, progress).report.interrupted) break;
      ++stops;
      ASSERT_TRUE(fs::exists(folder_ / out / "checkpoint.bin"));
    }
    expect_same(results(folder_ / out), expected);
    fs::remove_all(folder_ / out);
  }
  EXPECT_GT(stops, trials / 2);
}

TEST_F(CheckpointTest, ACompleteRunIsKnownByItsReport) {
  SilentProgress progress;
  EXPECT_FALSE(is_complete(scene_, folder_ / "out"));
  Stopping soon(20);
  go("out", soon);
  EXPECT_FALSE(is_complete(scene_, folder_ / "out"));
  go("out", progress);
  EXPECT_TRUE(is_complete(scene_, folder_ / "out"));
  scene_.seed = 2;
  EXPECT_FALSE(is_complete(scene_, folder_ / "out"));
}

TEST_F(CheckpointTest, WithoutResumeARunBeginsAnew) {
  Stopping soon(60), never(1000000);
  go("out", soon);
  ASSERT_TRUE(fs::exists(folder_ / "out" / "checkpoint.bin"));
  EXPECT_EQ(go("out", never, false).sequence.frames.front().time, 0);
}

TEST_F(CheckpointTest, CheckpointsOfOtherScenesAreRefusedAndKept) {
  Stopping soon(60);
  SilentProgress progress;
  go("out", soon);
  scene_.seed = 2;
  try {
    go("out", progress);
    FAIL() << "took a checkpoint of another seed";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::usage);
    EXPECT_NE(std::string(error.what()).find("another scene"), std::string::npos) << error.what();
  }
  EXPECT_TRUE(fs::exists(folder_ / "out" / "checkpoint.bin"));
}

TEST_F(CheckpointTest, DamagedCheckpointsAreRefused) {
  Stopping soon(60);
  go("out", soon);
  const fs::path file = folder_ / "out" / "checkpoint.bin";
  const std::string good = output::read_all(file);
  // Cut short, emptied, and with one wrong byte at ten places and wherever lengths stand at the beginning.
  std::vector<std::string> bad = {good.substr(0, good.size() / 2), good.substr(0, 30), "", "no checkpoint at all"};
  for (std::uint64_t i = 0; i < 10; ++i) {
    bad.push_back(good);
    bad.back()[static_cast<std::size_t>(random_unit(2, 0, i) * static_cast<double>(good.size()))] ^= 1;
  }
  for (std::size_t i = 0; i < 64; ++i) {
    bad.push_back(good);
    bad.back()[i] ^= 0x40;
  }
  for (const std::string& bytes : bad) {
    std::ofstream(file, std::ios::binary) << bytes;
    try {
      read_checkpoint(file, fingerprint(scene_));
      ADD_FAILURE() << "took " << bytes.size() << " bytes of " << good.size();
    } catch (const Error& error) {
      EXPECT_TRUE(error.kind() == ErrorKind::io || error.kind() == ErrorKind::usage) << error.what();
    }
  }
}

TEST_F(CheckpointTest, NoCheckpointIsNoError) {
  EXPECT_FALSE(read_checkpoint(folder_ / "none.bin", fingerprint(scene_)));
}

/// Starts the program and kills it after so long; true when it had ended by itself.
bool run_for(const std::vector<std::string>& words, double seconds) {
  const pid_t child = fork();
  if (child == 0) {
    std::freopen("/dev/null", "w", stdout);
    std::freopen("/dev/null", "w", stderr);
    std::vector<char*> argv;
    for (const std::string& word : words) argv.push_back(const_cast<char*>(word.c_str()));
    argv.push_back(nullptr);
    execv(argv[0], argv.data());
    _exit(127);
  }
  usleep(static_cast<useconds_t>(seconds * 1e6));
  kill(child, SIGKILL);
  int status = 0;
  waitpid(child, &status, 0);
  return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

/// Time until the program has ended by itself [s].
double seconds_to_end(const std::vector<std::string>& words) {
  std::string command;
  for (const std::string& word : words) command += word + " ";
  double seconds = 0;
  {
    const Stopwatch watch(seconds);
    EXPECT_EQ(std::system((command + ">/dev/null 2>&1").c_str()), 0);
  }
  return seconds;
}

// The whole program, twenty times killed at moments that nothing foresees.
class CheckpointSlowTest : public CheckpointTest {};

TEST_F(CheckpointSlowTest, ARunKilledAtRandomGoesOnToTheSameBytes) {
  const fs::path binary = fs::read_symlink("/proc/self/exe").parent_path() / "sunder";
  const std::string scene = (folder_ / "pane.toml").string();
  const auto words = [&](const std::string& out) {
    return std::vector<std::string>{binary.string(), "run", scene, "--resume", "--out", (folder_ / out).string()};
  };
  const double whole = seconds_to_end(words("whole"));
  constexpr int kills = 20;
  int killed = 0;
  for (std::uint64_t moment = 0; killed < kills; ++moment) {
    if (run_for(words("killed"), whole * random_unit(3, 0, moment))) {
      expect_same(results(folder_ / "killed"), results(folder_ / "whole"));
      fs::remove_all(folder_ / "killed");
    } else {
      ++killed;
    }
  }
  seconds_to_end(words("killed"));
  expect_same(results(folder_ / "killed"), results(folder_ / "whole"));
}

}  // namespace
}  // namespace sunder::pipeline
