#include "pipeline/command_line.h"

#include <cstdio>
#include <iostream>
#include <optional>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>
#include <tbb/global_control.h>
#include <unistd.h>

#include "geometry/inspect.h"
#include "geometry/load.h"
#include "pipeline/progress_display.h"
#include "pipeline/quality.h"
#include "pipeline/run.h"
#include "pipeline/validate.h"
#include "sunder_version.h"

namespace sunder::pipeline {
namespace {

struct RunArguments {
  std::string scene, out;
  std::optional<Quality> quality;
  std::optional<std::uint64_t> seed;
  int threads = 0;
};

const std::map<std::string, Quality> quality_words = {
    {"draft", Quality::draft}, {"preview", Quality::preview}, {"final", Quality::final}};
const std::map<std::string, LogFormat> log_words = {{"text", LogFormat::text}, {"json", LogFormat::json}};

nlohmann::ordered_json event(const FractureRecord& f) {
  return {{"event", "fracture"},
          {"body", f.body},
          {"time", f.time},
          {"fragments", f.fragments},
          {"particles", f.particles},
          {"steps", f.steps},
          {"seconds", f.seconds.sample + f.seconds.solve + f.seconds.extract + f.seconds.cut}};
}

void say(const nlohmann::ordered_json& json) { std::cout << json.dump() << std::endl; }

std::string sentence(const FractureRecord& f) {
  char text[256];
  std::snprintf(text, sizeof text,
                "%7.4f s  %s hit at %.2f m/s: %s, %.1f %% damaged, %ld particles x %ld steps in %.1f s", f.time,
                f.body.c_str(), f.approach_speed,
                f.fragments > 0 ? (std::to_string(f.fragments) + " fragments").c_str() : "stays whole",
                100 * f.damaged_share, f.particles, f.steps, f.seconds.solve);
  return text;
}

int run_command(const RunArguments& arguments, LogFormat log) {
  Scene scene = load_scene(arguments.scene);
  if (arguments.quality) scene.quality = *arguments.quality;
  if (arguments.seed) scene.seed = *arguments.seed;
  RunOptions options;
  options.out =
      arguments.out.empty() ? std::filesystem::path("out") / scene.name : std::filesystem::path(arguments.out);
  options.threads = arguments.threads;
  options.on_fracture = [&](const FractureRecord& f) {
    if (log == LogFormat::json)
      say(event(f));
    else
      std::cout << (isatty(STDERR_FILENO) ? "\r\x1b[K" : "") << sentence(f) << std::endl;
  };
  std::optional<tbb::global_control> limit;
  if (arguments.threads > 0)
    limit.emplace(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(arguments.threads));
  const auto progress = make_progress_display(log);
  const RunResult result = run(scene, options, *progress);
  if (log == LogFormat::json)
    say({{"event", result.report.interrupted ? "interrupted" : "done"},
         {"report", (options.out / "report.json").string()}});
  else
    std::cout << summary(result.report, result.sequence)
              << (result.report.interrupted ? "interrupted; what was finished is in " : "written to ")
              << options.out.string() << std::endl;
  return result.report.interrupted ? static_cast<int>(ErrorKind::interrupted) : 0;
}

int check_command(const std::string& file) {
  const Scene scene = load_scene(file);
  for (const SceneBody& body : scene.bodies) {
    const BodyMesh source = body_mesh(body);
    std::cout << body.name << ": " << source.mesh.faces.size() << " faces, " << body.material.name
              << (body.breakable && body.material.breakable && scene.effects.fracture ? "" : ", does not break")
              << "\n";
    for (const std::string& step : source.repairs) std::cout << "  repair: " << step << "\n";
  }
  std::cout << "scene is valid: " << scene.duration << " s at " << scene.frame_rate << " frames/s, quality "
            << name_of(scene.quality) << std::endl;
  return 0;
}

int inspect_command(const std::string& file, double unit) {
  geometry::LoadSettings settings;
  settings.metres_per_unit = unit;
  const geometry::MeshReport report = geometry::inspect(geometry::load_mesh(file, settings));
  const Vec3 size = report.box.sizes();
  std::cout << file << ": " << report.summary() << "\n"
            << report.vertices << " vertices, " << report.faces << " faces, " << report.shells << " shells, size "
            << size[0] << " x " << size[1] << " x " << size[2] << " m, volume " << report.volume << " m^3" << std::endl;
  return report.is_solid() ? 0 : static_cast<int>(ErrorKind::mesh);
}

int validate_command(const ValidateOptions& options) {
  const auto progress = make_progress_display(LogFormat::text);
  return validate(options, *progress) ? 0 : 1;
}

int dispatch(int argc, char** argv, LogFormat& log) {
  CLI::App app("Sunder breaks things the way they break: a scene file goes in, a shatter sequence comes out.");
  app.set_version_flag("--version", std::string(SUNDER_VERSION) + " (" + SUNDER_GIT + ")");
  app.require_subcommand(1);

  RunArguments run_arguments;
  auto* run_app = app.add_subcommand("run", "Simulate a scene");
  run_app->add_option("scene", run_arguments.scene, "Scene file (TOML)")->required();
  run_app->add_option("--out", run_arguments.out, "Folder for the results (default: out/<scene>)");
  run_app->add_option("--quality", run_arguments.quality, "draft, preview or final; overrides the scene")
      ->transform(CLI::CheckedTransformer(quality_words));
  run_app->add_option("--threads", run_arguments.threads, "Threads to use (default: all)")->check(CLI::Range(1, 1024));
  run_app->add_option("--seed", run_arguments.seed, "Overrides the scene's seed");
  run_app->add_option("--log", log, "text or json")->transform(CLI::CheckedTransformer(log_words));

  std::string check_file, mesh_file;
  double unit = 1;
  auto* check_app = app.add_subcommand("check", "Validate a scene and its meshes, simulate nothing");
  check_app->add_option("scene", check_file, "Scene file (TOML)")->required();
  auto* inspect_app = app.add_subcommand("inspect", "Say whether a mesh is a closed solid, and what is wrong with it");
  inspect_app->add_option("mesh", mesh_file, "Mesh file")->required();
  inspect_app->add_option("--unit", unit, "Metres per unit of the file")->check(CLI::PositiveNumber);

  ValidateOptions validate_options;
  auto* validate_app = app.add_subcommand(
      "validate", "Run the catalogue of validation problems; exit code 0 when every check holds, 1 when one fails");
  validate_app->add_option("--only", validate_options.only, "Ids of the problems to run (default: all)");
  validate_app->add_option("--json", validate_options.json, "File for the results");

  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : static_cast<int>(ErrorKind::usage);
  }
  if (*run_app) return run_command(run_arguments, log);
  if (*check_app) return check_command(check_file);
  if (*validate_app) return validate_command(validate_options);
  return inspect_command(mesh_file, unit);
}

int fail(LogFormat log, int code, const std::string& message) {
  if (log == LogFormat::json) say({{"event", "error"}, {"code", code}, {"message", message}});
  std::cerr << "sunder: " << message << std::endl;
  return code;
}

}  // namespace

int command_line(int argc, char** argv) {
  LogFormat log = LogFormat::text;
  try {
    return dispatch(argc, argv, log);
  } catch (const Error& error) {
    return fail(log, static_cast<int>(error.kind()), error.what());
  } catch (const std::bad_alloc&) {
    return fail(log, static_cast<int>(ErrorKind::internal), "out of memory; use a lower quality or a smaller mesh");
  } catch (const std::exception& error) {
    return fail(log, static_cast<int>(ErrorKind::internal), std::string("internal failure: ") + error.what());
  }
}

}  // namespace sunder::pipeline
