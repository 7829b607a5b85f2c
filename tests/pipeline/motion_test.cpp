/// How bodies move and hand over their motion, from the scene to the frames.
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "geometry/primitives.h"
#include "pipeline/handover.h"
#include "pipeline/run.h"
#include "tests/output/scratch_folder.h"

namespace sunder::pipeline {
namespace {

class Motion : public testing::Test {
 protected:
  Scene scene(const std::string& text) const {
    std::ofstream(folder_ / "scene.toml") << text;
    return load_scene(folder_ / "scene.toml");
  }
  RunResult run_scene(const Scene& chosen) const {
    SilentProgress progress;
    return run(chosen, {.out = folder_ / "out"}, progress);
  }

  output::ScratchFolder folder_;
};

const Pose& last_pose(const output::Sequence& sequence, int piece) {
  for (const output::PiecePose& p : sequence.frames.back().poses)
    if (p.piece == piece) return p.pose;
  throw Error(ErrorKind::internal, "the piece is gone");
}

TEST_F(Motion, DrivenBodiesAreWhereTheirPathsSay) {
  const RunResult result = run_scene(scene(R"(
[scene]
duration = 1
frame_rate = 20
[[body]]
name = "arm"
mesh = "box"
size = [0.4, 0.1, 0.1]
anchor = "centre"
motion = "kinematic"
material = "steel"
path = [{ time = 0, position = [0, 1, 0], rotation = [0, 0, 30] }, { time = 0.5, position = [1, 1, 0], rotation = [0, 90, 30] },
        { time = 1, position = [1, 2, 0] }]
[output]
obj = false
glb = false
page = false
poster = false
)"));
  const auto& frames = result.sequence.frames;
  ASSERT_EQ(frames.size(), 21u);
  EXPECT_LT((frames[5].poses[0].pose.position - Vec3(0.5, 1, 0)).norm(), 1e-9);
  EXPECT_LT((frames[10].poses[0].pose.position - Vec3(1, 1, 0)).norm(), 1e-9);
  EXPECT_LT((frames[20].poses[0].pose.position - Vec3(1, 2, 0)).norm(), 1e-9);
}

// The most of what leaves a fracture is what came in; weightless, so that nothing else changes it.
TEST_F(Motion, FlyingBodiesThatBreakKeepTheirMomentum) {
  const Scene flying = scene(R"(
[scene]
duration = 0.1
frame_rate = 60
gravity = [0, 0, 0]
quality = "draft"
[[body]]
name = "left"
mesh = "box"
size = [0.1, 0.02, 0.1]
anchor = "centre"
rotation = [0, 0, 90]
position = [-0.1, 0, 0]
velocity = [12, 0, 0]
material = "glass"
[[body]]
name = "right"
mesh = "box"
size = [0.08, 0.03, 0.1]
anchor = "centre"
rotation = [10, 0, 70]
position = [0.1, 0.03, 0.01]
velocity = [-9, 0, 1]
angular_velocity = [0, 0, 3]
material = "porcelain"
[output]
obj = false
glb = false
page = false
poster = false
)");
  const RunResult result = run_scene(flying);
  int broken = 0;
  for (const FractureRecord& f : result.report.fractures) {
    broken += f.fragments > 0;
    EXPECT_LT(f.momentum_error, 1e-9) << f.body;
    EXPECT_LE(f.kinetic_after, f.kinetic_before * (1 + 1e-9)) << f.body;
  }
  EXPECT_GE(broken, 1);
  // Linear momentum of the whole, from where everything is in the last two frames.
  Vec3 before = Vec3::Zero(), after = Vec3::Zero();
  double scale = 0;
  for (std::size_t b = 0; b < 2; ++b) {
    const output::Piece& piece = result.sequence.pieces[b];
    before += piece.mass * flying.bodies[b].velocity;
    scale += piece.mass * flying.bodies[b].velocity.norm();
  }
  const auto& frames = result.sequence.frames;
  const output::Frame &last = frames.back(), &previous = frames[frames.size() - 2];
  ASSERT_EQ(last.poses.size(), previous.poses.size()) << "something broke in the last frame";
  for (std::size_t k = 0; k < last.poses.size(); ++k)
    after += result.sequence.pieces[static_cast<std::size_t>(last.poses[k].piece)].mass * flying.frame_rate *
             (last.poses[k].pose.position - previous.poses[k].pose.position);
  // Contacts within the last frame are part of the mean, which changes nothing in the sum; positions are good to 1e-12.
  EXPECT_LT((after - before).norm() / scale, 1e-9);
}

// The frame rate does not divide the time evenly in binary, and a bullet of 120 m/s covers 12 thicknesses in a step.
TEST_F(Motion, AFastBulletDoesNotPassThroughAThinUnbreakableWall) {
  const RunResult result = run_scene(scene(R"(
[scene]
duration = 0.1
frame_rate = 24
[[body]]
name = "wall"
mesh = "box"
size = [0.02, 1, 1]
anchor = "centre"
motion = "fixed"
material = "steel"
[[body]]
name = "bullet"
mesh = "sphere"
height = 0.009
anchor = "centre"
position = [-0.3, 0.013, 0.007]
velocity = [120, 3, 0]
material = "steel"
[output]
obj = false
glb = false
page = false
poster = false
)"));
  EXPECT_LT(last_pose(result.sequence, 1).position.x(), -0.01);
}

// Hulls that closed the bowl would keep the marble out, or throw it off.
TEST_F(Motion, AGobletHoldsAMarble) {
  const RunResult result = run_scene(scene(R"(
[scene]
duration = 1.5
frame_rate = 20
[ground]
[[body]]
name = "goblet"
mesh = "goblet"
height = 0.2
wall = 0.003
material = "glass"
breakable = false
[[body]]
name = "marble"
mesh = "sphere"
height = 0.02
anchor = "centre"
position = [0.004, 0.18, 0.003]
material = "glass"
breakable = false
[output]
obj = false
glb = false
page = false
poster = false
)"));
  const Vec3 goblet = result.sequence.frames.front().poses[0].pose.position;
  EXPECT_LT((last_pose(result.sequence, 0).position - goblet).norm(), 2e-3) << "the goblet stands";
  const Vec3 marble = last_pose(result.sequence, 1).position;
  EXPECT_GT(marble.y(), 0.08) << "above the stem";
  EXPECT_LT(marble.y(), 0.12) << "well below the rim";
  EXPECT_LT(std::hypot(marble.x(), marble.z()), 0.02);
}

TEST_F(Motion, ABodyWithoutSubstanceIsRefusedByName) {
  for (const char* thickness : {"1e-9", "1e-160"}) {
    try {
      run_scene(scene("[[body]]\nname = \"sheet\"\nmesh = \"box\"\nsize = [0.2, " + std::string(thickness) +
                      ", 0.2]\nmaterial = \"glass\"\n"));
      FAIL() << "took a box " << thickness << " m thick";
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::usage);
      EXPECT_NE(std::string(error.what()).find("scene.toml:1: body 'sheet' cannot move"), std::string::npos)
          << error.what();
    }
  }
}

// D8: solved if and only if the impulse of the contact reaches the threshold.
TEST_F(Motion, NothingBreaksAnyMoreOnceThereAreEnoughFragments) {
  Scene many = scene(R"(
[scene]
duration = 0.24
frame_rate = 60
quality = "draft"
[ground]
[[body]]
name = "pane"
mesh = "plate"
size = [0.2, 0.01, 0.2]
position = [0, 0.3, 0]
material = "glass"
[[body]]
name = "ball"
mesh = "sphere"
size = [0.02, 0.02, 0.02]
anchor = "centre"
position = [0.03, 0.33, 0.02]
velocity = [0, -10, 0]
material = "steel"
[fracture]
refracture_delay = 0.002
minimum_impulse = 0.002
minimum_volume = 0.01
maximum_fractures = 50
[output]
obj = false
glb = false
page = false
poster = false
)");
  const auto breaks = [](const RunResult& result) {
    return std::count_if(result.report.fractures.begin(), result.report.fractures.end(),
                         [](const FractureRecord& f) { return f.fragments > 0; });
  };
  ASSERT_GT(breaks(run_scene(many)), 1);
  many.fracture.maximum_fragments = 1;
  EXPECT_EQ(breaks(run_scene(many)), 1) << "the first fracture makes more than one fragment";
  many.fracture.maximum_fragments = 0;
  EXPECT_EQ(breaks(run_scene(many)), 0);
}

// Four panes land at once: their solves run side by side.
TEST_F(Motion, SolvesSideBySideDoNotDependOnThreads) {
  std::string text =
      "[scene]\nduration = 0.017\nframe_rate = 60\nquality = \"draft\"\n[ground]\n[output]\nobj = false\n";
  for (int i = 0; i < 4; ++i)
    text +=
        "[[body]]\nname = \"pane" + std::to_string(i) +
        "\"\nmesh = \"plate\"\nsize = [0.15, 0.01, 0.15]\nmaterial = \"glass\"\nvelocity = [0, -6, 0]\nposition = [" +
        std::to_string(0.2 * i) + ", 0.001, 0]\n";
  const Scene panes = scene(text);
  std::vector<std::string> results;
  for (std::size_t threads : {1, 2, 4}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    const RunResult result = run_scene(panes);
    ASSERT_GE(result.report.fractures.size(), 4u);
    for (int i = 0; i < 4; ++i) EXPECT_EQ(result.report.fractures[static_cast<std::size_t>(i)].time, 0);
    results.push_back(output::read_all(folder_ / "out" / "fragments.glb"));
  }
  EXPECT_TRUE(results[1] == results[0]);
  EXPECT_TRUE(results[2] == results[0]);
}

}  // namespace
}  // namespace sunder::pipeline
