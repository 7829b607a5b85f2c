/// What a run leaves in its folder.
#include "pipeline/outputs.h"

#include <fstream>
#include <set>

#include <gtest/gtest.h>

#include "output/atomic_file.h"
#include "output/writers.h"

namespace sunder::pipeline {
namespace {

namespace fs = std::filesystem;

class OutputsTest : public testing::Test {
 protected:
  void SetUp() override {
    fs::remove_all(folder_);
    scene_ = load_scene(fs::path(SUNDER_SOURCE_DIR) / "assets/scenes/plate_ball.toml");
    scene_.quality = Quality::draft;
    scene_.duration = 0.08;
    scene_.start_frame = 1001;
  }
  void TearDown() override { fs::remove_all(folder_); }

  RunResult run_scene() const {
    SilentProgress progress;
    return run(scene_, {.out = folder_}, progress);
  }

  std::set<std::string> files() const {
    std::set<std::string> names;
    for (const auto& entry : fs::recursive_directory_iterator(folder_))
      if (entry.is_regular_file()) names.insert(fs::relative(entry.path(), folder_));
    return names;
  }

  /// The plan with its numbers filled in.
  std::set<std::string> expected(const Report& report) const {
    std::set<std::string> names;
    for (const PlannedFiles& planned : planned_files(scene_)) {
      const std::size_t at = planned.name.find("####");
      if (planned.count == 0) {
        for (const FractureRecord& f : report.fractures)
          names.insert("vdb/" + f.body + "." +
                       output::frame_number(output::frame_at(f.time, scene_.frame_rate, scene_.start_frame)) + ".vdb");
      } else if (at == std::string::npos) {
        names.insert(planned.name);
      } else {
        for (int k = 0; k < planned.count; ++k)
          names.insert(std::string(planned.name)
                           .replace(at, 4, output::frame_number(scene_.outputs.first_frame.value_or(1001) + k)));
      }
    }
    return names;
  }

  const fs::path folder_ = fs::path(testing::TempDir()) / ("sunder_outputs_" + std::to_string(getpid()));
  Scene scene_;
};

TEST_F(OutputsTest, ARunWritesExactlyWhatIsPlanned) {
  scene_.outputs.vdb = scene_.outputs.ply = scene_.outputs.usd = true;
  scene_.outputs.transforms = TransformTable::both;
  const RunResult all = run_scene();
  ASSERT_GE(all.report.fractures.size(), 1u);
  EXPECT_EQ(files(), expected(all.report));
  for (const char* stale : {"plate_ball.0001.obj", "plate_ball.1999.obj", "plate_ball.1999.ply", "vdb/plate.1900.vdb"})
    output::write_atomically(folder_ / stale, "of an earlier, longer run");
  output::write_atomically(folder_ / "plate_ball.notes.obj", "the user's own");
  const RunResult again = run_scene();
  std::set<std::string> kept = expected(again.report);
  kept.insert("plate_ball.notes.obj");
  EXPECT_EQ(files(), kept);
}

/// The materials of crack faces come into being after the first frame.
TEST_F(OutputsTest, EveryMaterialThatAFrameNamesIsDefined) {
  run_scene();
  std::set<std::string> used, defined;
  const auto collect = [&](const std::string& file, const std::string& tag, std::set<std::string>& names) {
    std::ifstream in(folder_ / file);
    for (std::string word, name; in >> word;)
      if (word == tag && in >> name) names.insert(name);
  };
  collect("plate_ball.1004.obj", "usemtl", used);
  collect("plate_ball.mtl", "newmtl", defined);
  EXPECT_TRUE(used.contains("glass_inside"));
  EXPECT_EQ(used, defined);
}

TEST_F(OutputsTest, ARangeOfFramesEndsTheRunAndLimitsTheFilesOfFrames) {
  const RunResult whole = run_scene();
  fs::remove_all(folder_);
  scene_.outputs.first_frame = 1002;
  scene_.outputs.last_frame = 1003;
  const RunResult part = run_scene();
  EXPECT_EQ(files(), expected(part.report));
  EXPECT_FALSE(files().contains("plate_ball.1001.obj"));
  ASSERT_EQ(part.sequence.frames.size(), 3u);
  for (std::size_t k = 0; k < 3; ++k)
    EXPECT_EQ(part.sequence.frames[k].poses[0].pose.position, whole.sequence.frames[k].poses[0].pose.position);
}

TEST_F(OutputsTest, NothingIsWrittenThatTheSceneDoesNotAskFor) {
  scene_.outputs = {};
  scene_.outputs.obj = scene_.outputs.glb = scene_.outputs.page = scene_.outputs.blender = false;
  scene_.outputs.fragments_csv = false;
  scene_.outputs.poster = false;
  run_scene();
  EXPECT_EQ(files(), (std::set<std::string>{"report.json", "scene.toml"}));
}

}  // namespace
}  // namespace sunder::pipeline
