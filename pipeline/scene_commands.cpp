#include "pipeline/scene_commands.h"

#include <charconv>
#include <cstdio>
#include <iostream>

#include <nlohmann/json.hpp>
#include <tbb/global_control.h>
#include <unistd.h>

#include "core/resources.h"
#include "output/atomic_file.h"
#include "pipeline/outputs.h"
#include "pipeline/prediction.h"
#include "pipeline/run.h"
#include "pipeline/simulation.h"

namespace sunder::pipeline {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

void say(const Json& json) { std::cout << json.dump() << std::endl; }

Json event(const FractureRecord& f) {
  return {{"event", "fracture"},
          {"body", f.body},
          {"time", f.time},
          {"fragments", f.fragments},
          {"particles", f.particles},
          {"steps", f.steps},
          {"seconds", f.seconds.sample + f.seconds.solve + f.seconds.extract + f.seconds.cut}};
}

/// "12", "1-48", "-5--1".
std::optional<std::pair<int, int>> frame_range(const std::string& text) {
  const char *at = text.data(), *end = text.data() + text.size();
  int first = 0, last = 0;
  auto read = std::from_chars(at, end, first);
  if (read.ec != std::errc()) return {};
  if (read.ptr == end) return {{first, first}};
  if (*read.ptr != '-') return {};
  read = std::from_chars(read.ptr + 1, end, last);
  if (read.ec != std::errc() || read.ptr != end) return {};
  return {{first, last}};
}

void choose_frames(Scene& scene, const std::string& frames) {
  if (frames.empty()) return;
  const std::string there = std::to_string(scene.start_frame) + "-" + std::to_string(last_frame(scene));
  const auto range = frame_range(frames);
  if (!range) throw Error(ErrorKind::usage, "--frames " + frames + ": expected one frame or a range such as " + there);
  const auto [first, last] = *range;
  if (first > last || first < scene.start_frame || last > last_frame(scene))
    throw Error(ErrorKind::usage, "--frames " + frames + ": the scene has the frames " + there);
  scene.outputs.first_frame = first;
  scene.outputs.last_frame = last;
}

/// What the command line says wins over the scene's own.
void choose_quality(Scene& scene, const std::optional<Quality>& quality, const std::optional<double>& time_budget) {
  if (quality && time_budget)
    throw Error(ErrorKind::usage, "--time-budget chooses the quality; give it or --quality, not both");
  if (time_budget) scene.time_budget = time_budget;
  if (!quality) return;
  scene.quality = *quality;
  scene.time_budget.reset();
}

Scene scene_of(const RunArguments& arguments) {
  Scene scene = load_scene(arguments.scene, default_assets(), arguments.overrides);
  choose_quality(scene, arguments.quality, arguments.time_budget);
  if (arguments.seed) scene.seed = *arguments.seed;
  choose_frames(scene, arguments.frames);
  return scene;
}

/// Places the bodies as a run does, so that what a run would refuse is refused here.
Simulation placed(const Scene& scene, const RunOptions& options) {
  SilentProgress progress;
  return Simulation(scene, options, progress);
}

Json plan_json(const EffectPlan& plan) {
  Json effects = Json::array();
  for (const EffectInfo& info : effect_registry())
    effects.push_back({{"name", info.name},
                       {"asked", name_of(plan.settings.asked[info.effect])},
                       {"runs", plan.runs(info.effect)},
                       {"why", plan.decisions[info.effect].why}});
  return effects;
}

void say_plan(const EffectPlan& plan) {
  for (const EffectInfo& info : effect_registry()) {
    const Decision& decision = plan.decisions[info.effect];
    char line[64];
    std::snprintf(line, sizeof line, "%-20s %-4s %-7s  ", std::string(info.name).c_str(),
                  name_of(plan.settings.asked[info.effect]), decision.runs ? "runs" : "skipped");
    std::cout << line << decision.why << "\n";
  }
}

void say_bodies(const Scene& scene, Simulation& simulation) {
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
    const SceneBody& body = scene.bodies[b];
    std::cout << body.name << ": " << simulation.sequence().pieces[b].mesh.faces.size() << " faces, "
              << body.material.name << (body.breakable && body.material.breakable ? "" : ", does not break") << "\n";
    for (const RepairRecord& repair : simulation.report().repairs)
      for (const std::string& step : repair.repair.steps)
        if (repair.body == body.name) std::cout << "  repair: " << step << "\n";
  }
}

int say_dry_run(const Scene& scene, const RunOptions& options, const LogSettings& log) {
  output::require_writable(options.out);
  Simulation simulation = placed(scene, options);
  const std::vector<PlannedFiles> files = planned_files(scene);
  if (log.format == LogFormat::json) {
    Json planned = Json::array();
    for (const PlannedFiles& file : files)
      planned.push_back({{"name", file.name}, {"count", file.count > 0 ? Json(file.count) : Json()}});
    say({{"event", "dry_run"},
         {"out", options.out.string()},
         {"first_frame", scene.start_frame},
         {"last_frame", last_frame(scene)},
         {"quality", name_of(scene.quality)},
         {"seed", scene.seed},
         {"effects", plan_json(simulation.effects())},
         {"files", planned}});
    return 0;
  }
  say_bodies(scene, simulation);
  say_plan(simulation.effects());
  std::cout << "would simulate frames " << scene.start_frame << "-" << last_frame(scene) << " at " << scene.frame_rate
            << " frames/s, quality " << name_of(scene.quality) << ", seed " << scene.seed << ", and write to "
            << options.out.string() << ":\n";
  for (const PlannedFiles& file : files)
    std::cout << "  " << file.name
              << (file.count == 0  ? ", one for each solve"
                  : file.count > 1 ? ", " + std::to_string(file.count) + " files"
                                   : std::string())
              << "\n";
  return 0;
}

int say_nothing_left(const fs::path& out, const LogSettings& log) {
  if (log.format == LogFormat::json)
    say({{"event", "done"}, {"report", (out / "report.json").string()}});
  else
    std::cout << "nothing left to do: " << out.string() << " holds the complete run" << std::endl;
  return 0;
}

int say_result(const RunResult& result, const fs::path& out, const LogSettings& log) {
  if (log.format == LogFormat::json)
    say({{"event", result.report.interrupted ? "interrupted" : "done"}, {"report", (out / "report.json").string()}});
  else
    std::cout << summary(result.report, result.sequence)
              << (result.report.interrupted ? "interrupted; --resume goes on with what is in " : "written to ")
              << out.string() << std::endl;
  return result.report.interrupted ? static_cast<int>(ErrorKind::interrupted) : 0;
}

}  // namespace

std::string sentence(const FractureRecord& f) {
  char text[256];
  std::snprintf(text, sizeof text,
                "%7.4f s  %s hit at %.2f m/s: %s, %.1f %% damaged, %ld particles x %ld steps in %.1f s", f.time,
                f.body.c_str(), f.approach_speed,
                f.fragments > 0 ? (std::to_string(f.fragments) + " fragments").c_str() : "stays whole",
                100 * f.damaged_share, f.particles, f.steps, f.seconds.solve);
  return text;
}

int run_command(const RunArguments& arguments, const LogSettings& log) {
  const Scene scene = scene_of(arguments);
  RunOptions options;
  options.out = arguments.out.empty() ? fs::path("out") / scene.name : fs::path(arguments.out);
  options.threads = arguments.threads;
  options.resume = arguments.resume;
  options.predict = arguments.predict;
  if (arguments.dry_run) return say_dry_run(scene, options, log);
  if (arguments.resume && is_complete(scene, options.out)) return say_nothing_left(options.out, log);
  options.on_solve = [&](const SettledSolve& solve) {
    if (log.format == LogFormat::json)
      say(event(solve.record));
    else
      std::cout << (isatty(STDERR_FILENO) ? "\r\x1b[K" : "") << sentence(solve.record) << std::endl;
  };
  std::optional<tbb::global_control> limit;
  if (arguments.threads > 0)
    limit.emplace(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(arguments.threads));
  const auto progress = make_progress_display(log);
  return say_result(run(scene, options, *progress), options.out, log);
}

namespace {

Json check_json(const Scene& scene, const EffectPlan& plan, const Prediction& prediction, double slowness) {
  return {{"quality", name_of(scene.quality)},
          {"particles", scene.quality.particles},
          {"accuracy", accuracy_of(scene.quality)},
          {"prediction",
           {{"seconds", prediction.seconds},
            {"processor_seconds", prediction.processor_seconds},
            {"peak_memory_mb", prediction.memory_mb},
            {"solves", prediction.solves},
            {"slowness", slowness}}},
          {"effects", plan_json(plan)}};
}

void say_prediction(const Scene& scene, const Prediction& p) {
  std::printf(
      "a run will take about %.0f s (%.0f s of processor time, %.0f MB); %d fractures of bodies and fragments\n",
      std::max(1.0, p.seconds), std::max(1.0, p.processor_seconds), p.memory_mb, p.solves);
  if (scene.time_budget && p.seconds > *scene.time_budget)
    std::printf("note: no quality fits into %.0f s; this is the coarsest one\n", *scene.time_budget);
  std::printf("%s\n", accuracy_of(scene.quality).c_str());
  std::fflush(stdout);
}

}  // namespace

int check_command(const CheckArguments& arguments) {
  Scene scene = load_scene(arguments.scene, default_assets(), arguments.overrides);
  choose_quality(scene, arguments.quality, arguments.time_budget);
  RunOptions options;
  options.threads = arguments.threads;
  SilentProgress progress;
  if (scene.time_budget) scene.quality = affordable_quality(scene, options, progress);
  const double start = cpu_seconds();
  Simulation simulation = placed(scene, options);
  const EffectPlan& plan = simulation.effects();
  const Forecaster forecaster(scene, simulation, cpu_seconds() - start, Forecaster::whole, progress);
  const Prediction prediction = forecaster.at(scene.quality, arguments.threads);
  if (arguments.json)
    return std::cout << check_json(scene, plan, prediction, forecaster.slowness()).dump(2) << std::endl, 0;
  say_bodies(scene, simulation);
  say_plan(plan);
  std::cout << "scene is valid: " << scene.duration << " s at " << scene.frame_rate << " frames/s, quality "
            << name_of(scene.quality) << std::endl;
  say_prediction(scene, prediction);
  return 0;
}

}  // namespace sunder::pipeline
