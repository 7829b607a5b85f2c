/// What a run leaves, loaded into Blender by the script that it leaves beside it.
#include <cstdlib>
#include <sstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "output/atomic_file.h"
#include "pipeline/run.h"
#include "tests/output/scratch_folder.h"

namespace sunder::pipeline {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

/// A stone cube is dropped on a glass plate that lies on the ground turned; nothing of the plate moves before it
/// breaks, so that its volume has to lie where it was placed.
const char* const kScene = R"(
[scene]
duration = 0.12
frame_rate = 29.97
start_frame = 1001
quality = "draft"
[ground]
[[body]]
name = "plate"
mesh = "plate"
size = [0.3, 0.01, 0.2]
position = [0.4, 0, -0.2]
rotation = [0, 30, 0]
material = "glass"
[[body]]
name = "ball"
mesh = "sphere"
height = 0.08
position = [0.42, 0.02, -0.21]
velocity = [0, -8, 0]
material = "steel"
[fracture]
maximum_fractures = 1
[output]
poster = false
obj = false
page = false
vdb = true
)";

json expected_of(const RunResult& result, const Scene& scene) {
  const output::Sequence& sequence = result.sequence;
  json expected = {{"scene", scene.name}, {"rate", scene.frame_rate}, {"first", 1001}, {"last", last_frame(scene)}};
  for (const output::Piece& piece : sequence.pieces)
    expected["pieces"][piece.name] = {{"parent", piece.parent}, {"faces", piece.mesh.faces.size()}};
  for (std::size_t f = 0; f < sequence.frames.size(); ++f) {
    json positions;
    for (const output::PiecePose& pose : sequence.frames[f].poses) {
      const Vec3& x = pose.pose.position;
      positions[sequence.pieces[static_cast<std::size_t>(pose.piece)].name] = {x.x(), x.y(), x.z()};
    }
    expected["frames"].push_back({{"number", 1001 + static_cast<int>(f)}, {"positions", positions}});
  }
  for (const auto& entry : fs::directory_iterator(scene.file.parent_path() / "out" / "vdb")) {
    const std::string name = entry.path().stem();
    if (!name.starts_with("plate.")) continue;
    // The level set's band of three voxels around the plate is nearly symmetric; a volume that is not turned is off by
    // far more.
    const Vec3& centre = sequence.frames[0].poses[0].pose.position;
    expected["volumes"][name] = {{"centre", {centre.x(), centre.y(), centre.z()}}, {"tolerance", 0.01}};
  }
  return expected;
}

TEST(BlenderSlow, LoadsPiecesMotionAndDamage) {
  const fs::path folder = fs::path(testing::TempDir()) / ("sunder_blender_" + std::to_string(getpid()));
  fs::remove_all(folder);
  output::create_folder(folder);
  output::write_atomically(folder / "shatter.toml", kScene);
  const Scene scene = load_scene(folder / "shatter.toml");
  SilentProgress progress;
  const RunResult result = run(scene, {.out = folder / "out"}, progress);
  ASSERT_EQ(result.report.fractures.size(), 1u) << "the plate breaks once, and is the only thing that breaks";
  output::write_atomically(folder / "expected.json", expected_of(result, scene).dump());
  std::ostringstream words;
  words << "SUNDER_EXPECTED=" << folder / "expected.json"
        << " blender -b --factory-startup --python-exit-code 3 -P " << folder / "out/import_blender.py"
        << " -P \"" SUNDER_SOURCE_DIR "/tests/pipeline/blender_check.py\" -- --save " << folder / "shatter.blend"
        << " > " << folder / "log"
        << " 2>&1";
  const std::string command = words.str();
  const int status = std::system(command.c_str());
  const std::string log = output::read_all(folder / "log");
  EXPECT_EQ(status, 0) << log;
  EXPECT_NE(log.find("blender_check: all as expected"), std::string::npos);
  EXPECT_TRUE(fs::exists(folder / "shatter.blend"));
  fs::remove_all(folder);
}

}  // namespace
}  // namespace sunder::pipeline
