/// The demo scenes end to end, at draft quality and cut short after the break, held to invariants.
#include "pipeline/run.h"

#include <fstream>
#include <iterator>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <tbb/global_control.h>

#include "geometry/inspect.h"
#include "geometry/mass_properties.h"

namespace sunder::pipeline {
namespace {

namespace fs = std::filesystem;

fs::path scratch(const std::string& name) {
  const fs::path folder = fs::path(testing::TempDir()) / ("sunder_run_" + name + "_" + std::to_string(getpid()));
  fs::remove_all(folder);
  return folder;
}

std::string content(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

Scene demo(const std::string& name, double duration) {
  Scene scene = load_scene(fs::path(SUNDER_SOURCE_DIR) / "assets/scenes" / (name + ".toml"));
  scene.quality = Quality::draft;
  scene.duration = duration;
  scene.outputs.obj = scene.outputs.poster = false;
  return scene;
}

RunResult run_quietly(const Scene& scene, const fs::path& out) {
  SilentProgress progress;
  return run(scene, {.out = out}, progress);
}

struct Demo {
  std::string name;
  double duration;  ///< long enough for the first fracture [s]
};

void PrintTo(const Demo& d, std::ostream* out) { *out << d.name; }

class DemoScene : public testing::TestWithParam<Demo> {};

std::vector<const output::Piece*> alive(const output::Sequence& sequence) {
  std::vector<const output::Piece*> pieces;
  for (const output::Piece& p : sequence.pieces)
    if (std::isinf(p.death_time)) pieces.push_back(&p);
  return pieces;
}

TEST_P(DemoScene, BreaksIntoClosedFragmentsThatAddUp) {
  const fs::path out = scratch(GetParam().name);
  const Scene scene = demo(GetParam().name, GetParam().duration);
  const RunResult result = run_quietly(scene, out);
  const output::Sequence& sequence = result.sequence;

  std::map<std::string, double> volume, original;
  int fragments = 0;
  for (const output::Piece& p : sequence.pieces) {
    if (p.parent < 0) original[p.body] = p.volume;
    EXPECT_GT(p.volume, 0) << p.name;
    EXPECT_TRUE(geometry::fits(p.surface, p.mesh)) << p.name;
    EXPECT_LT(geometry::mass_properties(p.mesh).centroid.norm(), 1e-9)
        << p.name << " is not centred on its centre of mass";
  }
  for (const output::Piece* p : alive(sequence)) {
    volume[p->body] += p->volume;
    if (p->parent < 0) continue;
    ++fragments;
    EXPECT_TRUE(geometry::inspect(p->mesh).is_solid()) << p->name << ": " << geometry::inspect(p->mesh).summary();
  }
  EXPECT_GT(fragments, 1);
  // The bound of the product; each cut is exact to rounding, so a run stays far below it.
  for (const auto& [body, sum] : volume) EXPECT_NEAR(sum / original[body], 1, 1e-6) << body;

  for (const FractureRecord& f : result.report.fractures) {
    EXPECT_LE(f.work_over_impact_energy, 1.0) << f.body;
    EXPECT_LE(f.kinetic_after, f.kinetic_before * (1 + 1e-9)) << f.body << ": breaking must not create energy";
    EXPECT_LT(f.momentum_error, 1e-9) << f.body;
    EXPECT_GT(f.steps, 0);
  }
  for (const output::Frame& frame : sequence.frames)
    for (const output::PiecePose& pose : frame.poses) {
      ASSERT_TRUE(pose.pose.position.allFinite()) << "frame at " << frame.time;
      ASSERT_NEAR(pose.pose.orientation.norm(), 1, 1e-9);
    }
  EXPECT_TRUE(fs::exists(out / "report.json"));
  EXPECT_TRUE(fs::exists(out / "fragments.glb"));
  fs::remove_all(out);
}

INSTANTIATE_TEST_SUITE_P(Run, DemoScene,
                         testing::Values(Demo{"plate_ball", 0.1}, Demo{"cup_drop", 0.1}, Demo{"pot_drop", 0.1},
                                         Demo{"armadillo_drop", 0.1}, Demo{"bunny_bullet", 0.05},
                                         Demo{"goblet_drop", 0.1}),
                         [](const auto& demo_info) { return demo_info.param.name; });

TEST(Run, TheSameSceneGivesTheSameBytesForAnyNumberOfThreads) {
  const Scene scene = [] {
    Scene s = demo("plate_ball", 0.08);
    s.outputs.obj = true;
    return s;
  }();
  std::vector<fs::path> folders;
  for (std::size_t threads : {1, 2, 4}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    folders.push_back(scratch("threads" + std::to_string(threads)));
    run_quietly(scene, folders.back());
  }
  int compared = 0;
  for (const auto& entry : fs::directory_iterator(folders[0])) {
    if (entry.path().filename() == "report.json" || entry.path().extension() == ".html") continue;
    for (std::size_t other : {1, 2})
      EXPECT_TRUE(content(entry.path()) == content(folders[other] / entry.path().filename()))
          << entry.path().filename();
    ++compared;
  }
  EXPECT_GT(compared, 3);
  for (const fs::path& folder : folders) fs::remove_all(folder);
}

TEST(Run, ASceneWithoutAHardHitNeverSamplesAParticle) {
  Scene scene = demo("cup_drop", 0.3);
  scene.bodies[0].velocity = Vec3(0, -0.05, 0);
  scene.bodies[0].position[1] += 1e-4;
  scene.fracture.minimum_impulse = 1e6;
  const fs::path out = scratch("soft");
  const RunResult result = run_quietly(scene, out);
  EXPECT_EQ(result.report.particle_steps, 0);
  EXPECT_EQ(result.sequence.pieces.size(), scene.bodies.size());
  for (const EffectRecord& effect : result.report.effects) {
    EXPECT_FALSE(effect.ran) << info_of(effect.effect).name;
    EXPECT_EQ(effect.work.count, 0) << info_of(effect.effect).name;
  }
  fs::remove_all(out);
}

TEST(Run, AnEffectThatIsOffStaysOff) {
  Scene scene = demo("plate_ball", 0.1);
  scene.effects.asked[Effect::fracture] = Ask::off;
  const fs::path out = scratch("off");
  EXPECT_EQ(run_quietly(scene, out).report.particle_steps, 0);
  fs::remove_all(out);
}

TEST(Run, FragmentsBreakAgainUnlessThatIsOff) {
  Scene scene = demo("plate_ball", 0.2);
  const auto again = [&] {
    const fs::path out = scratch("again");
    const RunResult result = run_quietly(scene, out);
    fs::remove_all(out);
    return result.report.effects[static_cast<std::size_t>(Effect::secondary_fracture)];
  };
  EXPECT_GT(again().work.count, 0);
  scene.effects.asked[Effect::secondary_fracture] = Ask::off;
  EXPECT_EQ(again().work.count, 0);
}

/// Stops as the user would, in the middle of the solve.
class ImpatientProgress final : public Progress {
 public:
  void report(std::string_view stage, double fraction) override {
    stop_ = stop_ || (stage == "solve" && fraction > 0.2);
  }
  bool cancelled() const override { return stop_; }

 private:
  bool stop_ = false;
};

TEST(Run, AnInterruptionLeavesWhatWasFinished) {
  const fs::path out = scratch("interrupted");
  ImpatientProgress progress;
  Scene scene = demo("plate_ball", 0.2);
  scene.outputs.obj = true;
  const RunResult result = run(scene, {.out = out}, progress);
  EXPECT_TRUE(result.report.interrupted);
  const auto report = nlohmann::json::parse(content(out / "report.json"));
  EXPECT_EQ(report["interrupted"], true);
  EXPECT_EQ(report["frames"]["count"], result.sequence.frames.size());
  EXPECT_TRUE(fs::exists(out / "fragments.glb"));
  int frames = 0;
  for (const auto& entry : fs::directory_iterator(out)) frames += entry.path().extension() == ".obj";
  EXPECT_EQ(frames, static_cast<int>(result.sequence.frames.size()));
  fs::remove_all(out);
}

TEST(Run, BodiesThatOverlapAtTheStartAreRefusedByName) {
  Scene scene = demo("cup_drop", 0.1);
  SceneBody second = scene.bodies[0];
  second.name = "intruder";
  second.line = 77;
  scene.bodies.push_back(second);
  try {
    run_quietly(scene, scratch("overlap"));
    FAIL() << "accepted";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::usage);
    EXPECT_NE(std::string(error.what()).find("intruder"), std::string::npos) << error.what();
  }
}

TEST(Run, AFolderThatCannotBeMadeIsAnIoError) {
  try {
    run_quietly(demo("plate_ball", 0.01), "/proc/sunder");
    FAIL() << "accepted";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::io);
  }
}

}  // namespace
}  // namespace sunder::pipeline
