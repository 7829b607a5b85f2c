#include "pipeline/run.h"

#include <cmath>
#include <fstream>
#include <thread>

#include <nlohmann/json.hpp>
#include <sys/resource.h>

#include "core/stopwatch.h"
#include "output/atomic_file.h"
#include "output/writers.h"
#include "pipeline/checkpoint.h"
#include "pipeline/quality.h"
#include "pipeline/report_page.h"
#include "pipeline/simulation.h"
#include "sunder_version.h"

namespace sunder::pipeline {
namespace {

int frame_count(const Scene& scene) {
  return static_cast<int>(std::floor(scene.duration * scene.frame_rate + 1e-9)) + 1;
}

double peak_memory_mb() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024;
}

/// Frames of an earlier, longer run would play on after the end of this one.
void remove_stale_frames(const std::filesystem::path& folder, const output::Sequence& sequence) {
  const int last = sequence.start_frame + static_cast<int>(sequence.frames.size()) - 1;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    const std::string file = entry.path().filename().string(), head = sequence.name + ".";
    if (!file.starts_with(head) || !file.ends_with(".obj")) continue;
    const std::string number = file.substr(head.size(), file.size() - head.size() - 4);
    if (number.empty() || number.find_first_not_of("0123456789") != std::string::npos || number.size() > 9) continue;
    if (const int frame = std::stoi(number); frame < sequence.start_frame || frame > last)
      std::filesystem::remove(entry.path());
  }
}

/// A run from its beginning or from a checkpoint.
class Run {
 public:
  Run(const Scene& scene, const RunOptions& options, Progress& progress)
      : scene_(scene), options_(options), fingerprint_(fingerprint(scene)) {
    std::optional<Checkpoint> checkpoint;
    if (options.resume) checkpoint = read_checkpoint(file(), fingerprint_);
    if (checkpoint) {
      steps_ = checkpoint->steps;
      simulation_.emplace(scene, options, checkpoint->world, std::move(checkpoint->simulation));
    } else {
      simulation_.emplace(scene, options, progress);
      record();
    }
  }

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
        if (interval > 0 && frames_done() % interval == 0 && frames_done() < frames) save();
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
  std::filesystem::path file() const { return options_.out / "checkpoint.bin"; }
  int frames_done() const { return static_cast<int>(simulation_->sequence().frames.size()); }

  void record() {
    simulation_->record_frame();
    if (!scene_.outputs.obj) return;
    const Stopwatch watch(simulation_->report().seconds.write);
    output::write_obj_frame(simulation_->sequence(), simulation_->sequence().frames.size() - 1, options_.out);
  }

  void save() {
    const Stopwatch watch(simulation_->report().seconds.checkpoint);
    write_checkpoint(file(), fingerprint_, steps_, *simulation_);
  }

  const Scene& scene_;
  const RunOptions& options_;
  std::string fingerprint_;
  std::optional<Simulation> simulation_;
  int steps_ = 0;  ///< since the last frame
};

}  // namespace

bool is_complete(const Scene& scene, const std::filesystem::path& out) {
  std::ifstream in(out / "report.json");
  if (!in) return false;
  const auto report = nlohmann::json::parse(in, nullptr, false);
  return report.is_object() && report.value("fingerprint", "") == fingerprint(scene) &&
         report.value("git", "") == SUNDER_GIT && !report.value("interrupted", true);
}

RunResult run(const Scene& scene, const RunOptions& options, Progress& progress) {
  output::create_folder(options.out);
  output::remove_abandoned(options.out);
  double total = 0;
  RunResult result;
  {
    const Stopwatch watch(total);
    Run run(scene, options, progress);
    Simulation& simulation = run.simulation();
    const bool complete = run.finish(progress);
    result.report = simulation.report();
    result.report.fingerprint = run.scene_fingerprint();
    result.report.interrupted = !complete;
    result.report.effects = effect_records(simulation.effects(), total_work(result.report.fractures));
    result.sequence = simulation.take_sequence();
    if (scene.outputs.obj && complete) remove_stale_frames(options.out, result.sequence);
    const Stopwatch writing(result.report.seconds.write);
    if (scene.outputs.glb) output::write_glb(result.sequence, options.out / "fragments.glb");
    if (complete) run.remove_checkpoint();
  }
  Report& report = result.report;
  report.scene = scene.name;
  report.quality = name_of(scene.quality);
  report.seed = scene.seed;
  report.threads = options.threads > 0 ? options.threads : static_cast<int>(std::thread::hardware_concurrency());
  report.seconds.total += total;
  report.peak_memory_mb = peak_memory_mb();
  keep_scene(scene.file, options.out);
  output::write_atomically(options.out / "report.json", to_json(report, result.sequence));
  return result;
}

}  // namespace sunder::pipeline
