#include "pipeline/run.h"

#include <chrono>
#include <fstream>
#include <thread>

#include <nlohmann/json.hpp>

#include "core/resources.h"
#include "core/stopwatch.h"
#include "output/atomic_file.h"
#include "pipeline/checkpoint.h"
#include "pipeline/fingerprint.h"
#include "pipeline/outputs.h"
#include "pipeline/prediction.h"
#include "pipeline/report_page.h"
#include "pipeline/simulation.h"
#include "sunder_version.h"

namespace sunder::pipeline {
namespace {

int frame_count(const Scene& scene) { return last_frame(scene) - scene.start_frame + 1; }

constexpr double kMostSaving = 0.05;  // share of the time that checkpoints may take after the first one

std::filesystem::path checkpoint_file(const std::filesystem::path& out) { return out / "checkpoint.bin"; }

/// The scene at the quality that its time budget allows, or that it was begun with.
Scene within_budget(Scene scene, const RunOptions& options, const std::optional<Checkpoint>& checkpoint,
                    Progress& progress) {
  if (!scene.time_budget) return scene;
  const auto begun = checkpoint ? quality_of(checkpoint->simulation.report.quality) : std::nullopt;
  scene.quality = begun ? *begun : affordable_quality(scene, options, progress);
  return scene;
}

/// A run from its beginning or from a checkpoint.
class Run {
 public:
  /// Goes on from `checkpoint`, if there is one.
  Run(const Scene& scene, const RunOptions& options, std::optional<Checkpoint> checkpoint, Progress& progress)
      : scene_(scene), options_(options), fingerprint_(fingerprint(scene)) {
    options_.on_solve = [this, &options](const SettledSolve& solve) {
      {
        const Stopwatch watch(simulation_->report().seconds.write);
        write_solve(scene_, solve, options_.out);
      }
      options.on_solve(solve);
    };
    if (checkpoint) {
      steps_ = checkpoint->steps;
      simulation_.emplace(scene, options_, checkpoint->world, std::move(checkpoint->simulation));
    } else {
      const double start = cpu_seconds();
      simulation_.emplace(scene, options_, progress);
      Report& report = simulation_->report();
      report.quality = name_of(scene.quality);
      if (options.predict)
        report.prediction = Forecaster(scene, *simulation_, cpu_seconds() - start, Forecaster::little, progress)
                                .at(scene.quality, options.threads);
      record();
    }
  }
  Run(const Run&) = delete;
  Run& operator=(const Run&) = delete;

  /// Steps through the frames that are left; false when the user stopped it.
  bool finish(Progress& progress) {
    const int frames = frame_count(scene_);
    try {
      for (int done = frames_done(); done < frames; ++done) {
        progress.checkpoint("total", static_cast<double>(done - 1) / (frames - 1));
        for (; steps_ < simulation_->steps_per_frame(); ++steps_) simulation_->step(progress);
        steps_ = 0;
        record();
        const int interval = scene_.outputs.checkpoint_interval;
        save_due_ |= interval > 0 && frames_done() % interval == 0;
        if (save_due_ && affords_save() && frames_done() < frames) save();
      }
      progress.report("total", 1);
      return true;
    } catch (const Error& error) {
      if (error.kind() != ErrorKind::interrupted) throw;
      save();
      return false;
    }
  }

  Simulation& simulation() { return *simulation_; }
  const std::string& scene_fingerprint() const { return fingerprint_; }
  void remove_checkpoint() const {
    std::error_code ignored;
    std::filesystem::remove(file(), ignored);
  }

 private:
  std::filesystem::path file() const { return checkpoint_file(options_.out); }
  int frames_done() const { return static_cast<int>(simulation_->sequence().frames.size()); }

  void record() {
    simulation_->record_frame();
    const Stopwatch watch(simulation_->report().seconds.write);
    write_newest_frame(scene_, simulation_->sequence(), options_.out, obj_);
  }

  bool affords_save() const {
    const std::chrono::duration<double> ran = std::chrono::steady_clock::now() - begun_;
    return save_seconds_ <= kMostSaving * ran.count();
  }

  void save() {
    const double before = simulation_->report().seconds.checkpoint;
    {
      const Stopwatch watch(simulation_->report().seconds.checkpoint);
      write_checkpoint(file(), fingerprint_, steps_, *simulation_);
    }
    save_seconds_ += simulation_->report().seconds.checkpoint - before;
    save_due_ = false;
  }

  const Scene& scene_;
  RunOptions options_;
  std::string fingerprint_;
  std::optional<Simulation> simulation_;
  output::ObjFrames obj_;
  int steps_ = 0;  ///< since the last frame
  const std::chrono::steady_clock::time_point begun_ = std::chrono::steady_clock::now();
  double save_seconds_ = 0;  ///< since it was begun
  bool save_due_ = false;
};

}  // namespace

bool is_complete(const Scene& scene, const std::filesystem::path& out) {
  std::ifstream in(out / "report.json");
  if (!in) return false;
  const auto report = nlohmann::json::parse(in, nullptr, false);
  return report.is_object() && report.value("fingerprint", "") == fingerprint(scene) &&
         report.value("git", "") == SUNDER_GIT && !report.value("interrupted", true);
}

RunResult run(const Scene& asked, const RunOptions& options, Progress& progress) {
  output::create_folder(options.out);
  output::require_writable(options.out);
  output::remove_abandoned(options.out);
  double total = 0;
  const double processor = cpu_seconds();
  RunResult result;
  std::optional<Checkpoint> checkpoint;
  if (options.resume) checkpoint = read_checkpoint(checkpoint_file(options.out), fingerprint(asked));
  const Scene scene = within_budget(asked, options, checkpoint, progress);
  {
    const Stopwatch watch(total);
    Run run(scene, options, std::move(checkpoint), progress);
    Simulation& simulation = run.simulation();
    const bool complete = run.finish(progress);
    result.report = simulation.report();
    result.report.fingerprint = run.scene_fingerprint();
    result.report.interrupted = !complete;
    result.report.effects = effect_records(simulation.effects(), total_work(result.report.fractures));
    result.sequence = simulation.take_sequence();
    if (complete) remove_stale_files(scene, result.report, options.out);
    const Stopwatch writing(result.report.seconds.write);
    write_whole_run(scene, result.sequence, options.out);
    if (complete) run.remove_checkpoint();
  }
  Report& report = result.report;
  report.scene = scene.name;
  report.seed = scene.seed;
  report.threads = options.threads > 0 ? options.threads : static_cast<int>(std::thread::hardware_concurrency());
  report.seconds.total += total;
  report.seconds.processor += cpu_seconds() - processor;
  report.peak_memory_mb = peak_memory_mb();
  keep_scene(scene.file, options.out);
  output::write_atomically(options.out / "report.json", to_json(report, result.sequence));
  if (scene.outputs.page) write_report_page(options.out);
  return result;
}

}  // namespace sunder::pipeline
