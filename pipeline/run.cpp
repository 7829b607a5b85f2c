#include "pipeline/run.h"

#include <cmath>
#include <thread>

#include <sys/resource.h>

#include "core/stopwatch.h"
#include "pipeline/quality.h"
#include "pipeline/simulation.h"

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
void remove_stale_frames(const std::filesystem::path& folder, const Sequence& sequence) {
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

class Recorder {
 public:
  Recorder(const Scene& scene, const RunOptions& options, Simulation& simulation)
      : scene_(scene), options_(options), simulation_(simulation) {}

  void frame() {
    simulation_.record_frame();
    if (!scene_.outputs.obj) return;
    const Stopwatch watch(simulation_.report().seconds.write);
    write_obj_frame(simulation_.sequence(), simulation_.sequence().frames.size() - 1, options_.out);
  }

 private:
  const Scene& scene_;
  const RunOptions& options_;
  Simulation& simulation_;
};

/// Steps through all frames; false when the user stopped it.
bool simulate(const Scene& scene, Simulation& simulation, Recorder& recorder, Progress& progress) {
  const int frames = frame_count(scene);
  try {
    recorder.frame();
    for (int frame = 1; frame < frames; ++frame) {
      progress.checkpoint("total", static_cast<double>(frame - 1) / (frames - 1));
      for (int n = 0; n < simulation.steps_per_frame(); ++n) simulation.step(progress);
      recorder.frame();
    }
    progress.report("total", 1);
    return true;
  } catch (const Error& error) {
    if (error.kind() != ErrorKind::interrupted) throw;
    return false;
  }
}

}  // namespace

RunResult run(const Scene& scene, const RunOptions& options, Progress& progress) {
  create_folder(options.out);
  double total = 0;
  RunResult result;
  {
    const Stopwatch watch(total);
    Simulation simulation(scene, options, progress);
    Recorder recorder(scene, options, simulation);
    const bool complete = simulate(scene, simulation, recorder, progress);
    result.report = simulation.report();
    result.report.interrupted = !complete;
    result.report.effects = effect_records(simulation.effects(), total_work(result.report.fractures));
    result.sequence = simulation.take_sequence();
    if (scene.outputs.obj && complete) remove_stale_frames(options.out, result.sequence);
    const Stopwatch writing(result.report.seconds.write);
    if (scene.outputs.glb) write_glb(result.sequence, options.out / "fragments.glb");
  }
  Report& report = result.report;
  report.scene = scene.name;
  report.quality = name_of(scene.quality);
  report.seed = scene.seed;
  report.threads = options.threads > 0 ? options.threads : static_cast<int>(std::thread::hardware_concurrency());
  report.seconds.total = total;
  report.peak_memory_mb = peak_memory_mb();
  write_atomically(options.out / "report.json", to_json(report, result.sequence));
  return result;
}

}  // namespace sunder::pipeline
