#include "cli/command_line.h"

#include <iostream>
#include <optional>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "batch/batch.h"
#include "batch/page.h"
#include "geometry/load.h"
#include "pipeline/accuracy.h"
#include "pipeline/inspect_command.h"
#include "pipeline/progress_display.h"
#include "pipeline/report_command.h"
#include "pipeline/scene_commands.h"
#include "pipeline/still.h"
#include "pipeline/validate.h"
#include "pipeline/version.h"

namespace sunder::cli {
namespace {

using namespace pipeline;

const std::map<std::string, geometry::UpAxis> axes = {
    {"x", geometry::UpAxis::x}, {"y", geometry::UpAxis::y}, {"z", geometry::UpAxis::z}};
const std::map<std::string, LogFormat> log_words = {{"text", LogFormat::text}, {"json", LogFormat::json}};
const std::map<std::string, ProgressFormat> progress_words = {
    {"auto", ProgressFormat::by_log}, {"openjd", ProgressFormat::openjd}, {"off", ProgressFormat::off}};

const std::map<std::string, batch::Engine> engine_words = {{"local", batch::Engine::local},
                                                           {"slurm", batch::Engine::slurm}};

int validate_command(const ValidateOptions& options) {
  const auto progress = make_progress_display({});
  return validate(options, *progress) ? 0 : 1;
}

int accuracy_command(AccuracyOptions options) {
  if (options.out.empty()) options.out = std::filesystem::path("out") / (options.scene.stem().string() + "_accuracy");
  const auto progress = make_progress_display({});
  measure_accuracy(options, *progress);
  std::cout << "written to " << options.out.string() << std::endl;
  return 0;
}

using Triple = std::vector<double>;

std::optional<Vec3> vector_of(const Triple& triple) {
  if (triple.empty()) return {};
  return Vec3(triple[0], triple[1], triple[2]);
}

struct StillArguments {
  FractureOptions fracture;
  ExtractOptions extract;
  Triple at, direction;
  std::string out;
};

int say_still(const StillResult& result, const std::filesystem::path& out) {
  if (result.report.extract) {
    const ExtractRecord& e = *result.report.extract;
    std::cout << e.points << " points, " << e.sites << " sites: " << e.pieces << " pieces, "
              << e.interior + e.extension + e.partial << " crack faces (" << e.interior << " interior, " << e.extension
              << " extension, " << e.partial << " partial)\n";
  }
  for (const FractureRecord& f : result.report.fractures) std::cout << sentence(f) << "\n";
  if (!result.sequence.pieces.empty() || !result.report.notes.empty())
    std::cout << summary(result.report, result.sequence);
  std::cout << "written to " << out.string() << std::endl;
  return 0;
}

int fracture_command(StillArguments& arguments, const LogSettings& log) {
  FractureOptions& options = arguments.fracture;
  options.at = vector_of(arguments.at);
  options.direction = vector_of(arguments.direction);
  if (options.cells == 0 && !(options.at && (options.impulse > 0 || options.severity > 0)))
    throw Error(
        ErrorKind::usage,
        "fracture needs --at x,y,z and --impulse N*s or --severity, or --cells N for a shatter without physics");
  if (options.direction && !(options.direction->norm() > 0)) throw Error(ErrorKind::usage, "--direction has no length");
  options.out =
      arguments.out.empty() ? std::filesystem::path("out") / options.mesh.stem() : std::filesystem::path(arguments.out);
  const auto progress = make_progress_display(log);
  return say_still(fracture_mesh(options, *progress), options.out);
}

int extract_command(StillArguments& arguments, const LogSettings& log) {
  ExtractOptions& options = arguments.extract;
  options.out = arguments.out.empty() ? std::filesystem::path("out") / options.points.stem()
                                      : std::filesystem::path(arguments.out);
  const auto progress = make_progress_display(log);
  return say_still(extract_points(options, *progress), options.out);
}

template <class Target>
void add_quality(CLI::App& app, Target& quality, const std::string& more) {
  const auto read = [&quality](const std::string& text) {
    const auto known = quality_of(text);
    if (!known) throw CLI::ValidationError("--quality", text + " is not " + quality_words());
    quality = *known;
  };
  app.add_option_function<std::string>("--quality", read, quality_words() + more);
}

void add_time_budget(CLI::App& app, std::optional<double>& seconds) {
  const auto read = [&seconds](const std::string& text) {
    seconds = duration_of(text);
    if (!seconds) throw CLI::ValidationError("--time-budget", text + " is not a time such as 90, '90 s', 5min or 2h");
  };
  app.add_option_function<std::string>("--time-budget", read,
                                       "The finest quality with which a run takes so long: 90, 5min, 2h");
}

/// Options that `fracture` and `extract` share.
void add_still_options(CLI::App& app, StillOptions& options, std::string& out) {
  std::vector<std::string> looks = crack::detail_preset_names();
  app.add_option("--out", out, "Folder for the results (default: out/<name>)");
  app.add_option("--unit", options.load.metres_per_unit, "Metres per unit of the files")->check(CLI::PositiveNumber);
  app.add_option("--seed", options.seed, "Of everything random");
  const auto switch_on = [&options](Effect effect) {
    return [&options, effect](const std::string&) { options.effects.asked[effect] = Ask::on; };
  };
  app.add_option("--detail", options.effects.surface_look, "Look of the crack faces")
      ->check(CLI::IsMember(looks))
      ->each(switch_on(Effect::surface_detail));
  app.add_option("--hairlines", options.effects.hairline_width, "Width of gaps that show partial cracks [m]")
      ->check(CLI::PositiveNumber)
      ->each(switch_on(Effect::hairlines));
  app.add_option("--debris", options.effects.debris_size, "Crushed lumps fall into pieces of this size [m]")
      ->check(CLI::PositiveNumber)
      ->each(switch_on(Effect::debris));
  app.add_flag("--level-set", options.fracture.level_set_cut, "Cut on a voxel grid instead of exactly");
  app.add_option("--voxel", options.fracture.voxel_size, "Voxel size of that grid [m]")->check(CLI::PositiveNumber);
}

void add_inspect(CLI::App& app, InspectOptions& options) {
  app.add_option("mesh", options.mesh, "Mesh file")->required();
  app.add_option("--unit", options.load.metres_per_unit, "Metres per unit of the file")->check(CLI::PositiveNumber);
  app.add_option("--up", options.load.up, "Up axis of the file: x, y or z")->transform(CLI::CheckedTransformer(axes));
  app.add_option("--part", options.load.part, "Only the mesh or node of this name");
  app.add_option("--height", options.height, "Scale the mesh to this height [m]")->check(CLI::PositiveNumber);
  app.add_flag("--json", options.json, "As JSON");
}

void add_fracture(CLI::App& app, StillArguments& arguments) {
  FractureOptions& options = arguments.fracture;
  app.add_option("mesh", options.mesh, "Mesh file, or a name of assets/meshes.toml")->required();
  app.add_option("--at", arguments.at, "Where it is hit: x,y,z [m], the nearest point of the surface")
      ->delimiter(',')
      ->expected(3);
  auto* impulse = app.add_option("--impulse", options.impulse, "Momentum of the impactor, a steel ball [N s]")
                      ->check(CLI::PositiveNumber);
  app.add_option("--severity", options.severity, "Instead of --impulse, as a multiple of what could open one crack")
      ->check(CLI::PositiveNumber)
      ->excludes(impulse);
  app.add_option("--speed", options.speed, "Speed of the impactor [m/s]")->check(CLI::PositiveNumber);
  app.add_option("--direction", arguments.direction, "x,y,z in which it flies (default: against the surface)")
      ->delimiter(',')
      ->expected(3);
  app.add_option("--material", options.material, "Material of assets/materials.toml");
  add_quality(app, options.quality, "");
  app.add_option("--cells", options.cells, "No impact: shatter into so many Voronoi cells")
      ->check(CLI::Range(2, 100000));
  app.add_option("--up", options.load.up, "Up axis of the mesh: x, y or z")->transform(CLI::CheckedTransformer(axes));
  app.add_option("--height", options.height, "Scale the mesh to this height [m]")->check(CLI::PositiveNumber);
  add_still_options(app, options, arguments.out);
}

void add_extract(CLI::App& app, StillArguments& arguments) {
  ExtractOptions& options = arguments.extract;
  app.add_option("points", options.points, "Text, PLY or VDB with x y z damage [damage_time]")->required();
  app.add_option("--mesh", options.mesh, "Body to cut: mesh file, or a name of assets/meshes.toml");
  app.add_option("--spacing", options.fracture.node_spacing, "Of the nodes on which damage is measured [m]")
      ->check(CLI::PositiveNumber)
      ->required();
  add_still_options(app, options, arguments.out);
}

void add_overrides(CLI::App& app, std::vector<Override>& overrides) {
  const auto read = [&overrides](const std::vector<std::string>& texts) {
    for (const std::string& text : texts) {
      const std::size_t at = text.find('=');
      if (at == std::string::npos || at == 0) throw CLI::ValidationError("--set", text + " is not KEY=VALUE");
      overrides.push_back({text.substr(0, at), text.substr(at + 1)});
    }
  };
  app.add_option_function<std::vector<std::string>>(
         "--set", read, "KEY=VALUE in place of the scene's, the value as in TOML: body.cup.velocity=[0,-5,0]")
      ->take_all()
      ->allow_extra_args(false);
}

void add_run(CLI::App& app, RunArguments& arguments, LogSettings& log) {
  app.add_option("scene", arguments.scene, "Scene file (TOML)")->required();
  app.add_option("--out", arguments.out, "Folder for the results (default: out/<scene>)");
  add_quality(app, arguments.quality, "; overrides the scene");
  add_time_budget(app, arguments.time_budget);
  app.add_option("--threads", arguments.threads, "Threads to use (default: all)")->check(CLI::Range(1, 1024));
  app.add_flag("!--no-prediction", arguments.predict,
               "Leave out the pilot that predicts what the run takes, for the report");
  app.add_flag("--resume", arguments.resume, "Go on where a run into the same folder was stopped");
  app.add_option("--seed", arguments.seed, "Overrides the scene's seed");
  add_overrides(app, arguments.overrides);
  app.add_option("--frames", arguments.frames,
                 "A-B or B: end with frame B; files that come one a frame are written from A on");
  app.add_flag("--dry-run", arguments.dry_run, "Check all, say what would run and be written, and stop");
  app.add_option("--log", log.format, "What happens as text or json")->transform(CLI::CheckedTransformer(log_words));
  app.add_option("--progress", log.progress, "auto (a bar, or as the log), openjd (Open Job Description), off")
      ->transform(CLI::CheckedTransformer(progress_words));
}

void add_batch(CLI::App& app, batch::BatchOptions& options, LogSettings& log) {
  app.add_option("plan", options.plan, "Plan file (TOML)")->required();
  app.add_option("--out", options.out, "Folder for the results (default: out/<plan>)");
  app.add_option("--workers", options.workers, "Jobs side by side (default: as many as processors and memory allow)")
      ->check(CLI::Range(1, 4096));
  app.add_option("--threads", options.threads, "Threads of one job (default: 1)")->check(CLI::Range(1, 1024));
  app.add_option("--jobs", options.jobs, "A-B: only these, without a manifest");
  app.add_flag("--dry-run", options.dry_run, "List the jobs, say what they will take, and stop");
  app.add_flag("--retry", options.retry, "Do jobs again that failed");
  app.add_flag("--yes", options.yes, "Also a very large number of jobs");
  auto* collect = app.add_flag("--collect", options.collect, "Only write the manifest of what is there");
  app.add_flag("--status", options.status, "Only say how far it is")->excludes(collect);
  app.add_option("--engine", options.engine, "local, or slurm: arrays of tasks on a cluster")
      ->transform(CLI::CheckedTransformer(engine_words));
  app.add_flag("--print-script", options.print_script, "Of slurm: print what would be submitted, and stop");
  app.add_option("--task-minutes", options.task_minutes, "Of slurm: how long a task should last")
      ->check(CLI::Range(0.0001, 10000.0));
  app.add_option("--tasks-at-once", options.tasks_at_once, "Of slurm: at most so many")->check(CLI::PositiveNumber);
  app.add_option("--progress", log.progress, "auto (a bar, or lines), openjd (Open Job Description), off")
      ->transform(CLI::CheckedTransformer(progress_words));
}

int batch_command(const batch::BatchOptions& options, const LogSettings& log) {
  const auto progress = make_progress_display(log);
  return batch::batch(options, *progress);
}

void add_check(CLI::App& app, CheckArguments& check) {
  app.add_option("scene", check.scene, "Scene file (TOML)")->required();
  add_quality(app, check.quality, "; overrides the scene");
  add_time_budget(app, check.time_budget);
  add_overrides(app, check.overrides);
  app.add_option("--threads", check.threads, "Threads of the run (default: all)")->check(CLI::Range(1, 1024));
  app.add_flag("--json", check.json, "Say it as JSON");
}

void add_accuracy(CLI::App& app, AccuracyOptions& accuracy) {
  app.add_option("scene", accuracy.scene, "Scene file (TOML)")->required();
  app.add_option("--out", accuracy.out, "Folder for the results (default: out/<scene>_accuracy)");
  app.add_option("--particles", accuracy.most_particles, "Of the finest resolution")
      ->check(CLI::Range(Quality::least_particles, Quality::most_particles));
  app.add_option("--seeds", accuracy.seeds, "By which the spread is measured")->check(CLI::Range(1, 100));
  app.add_option("--hits", accuracy.hits, "How many of the hits that break bodies are studied")
      ->check(CLI::Range(1, 1000));
}

void add_validate(CLI::App& app, ValidateOptions& options) {
  app.add_option("--only", options.only, "Ids of the problems to run (default: all)");
  app.add_flag("--hard", options.hard, "The hard cases instead: extreme sizes, speeds, materials, meshes and scenes");
  app.add_option("--resolution", options.resolutions,
                 "Resolutions at which the problem named by --only is studied: 16,32,64")
      ->delimiter(',')
      ->check(CLI::Range(2, 100000));
  app.add_option("--json", options.json, "File for the results");
  app.add_option("--svg", options.svg, "File for the overview of error against time");
  app.add_option("--html", options.html, "File for the results as a page with charts");
}

int any_report_command(const std::filesystem::path& folder) {
  if (!batch::is_batch(folder)) return report_command(folder);
  batch::write_batch_page(folder);
  std::cout << "written to " << (folder / "index.html").string() << std::endl;
  return 0;
}

int dispatch(int argc, char** argv, LogSettings& log) {
  CLI::App app("Sunder breaks things the way they break: a scene file goes in, a shatter sequence comes out.");
  app.set_version_flag("--version", build_name());
  app.require_subcommand(1);

  RunArguments run_arguments;
  auto* run_app = app.add_subcommand("run", "Simulate a scene");
  add_run(*run_app, run_arguments, log);
  CheckArguments check;
  auto* check_app = app.add_subcommand(
      "check", "Validate a scene and its meshes, say which effects will run and what a run takes, solve nothing");
  add_check(*check_app, check);
  InspectOptions inspect_options;
  auto* inspect_app = app.add_subcommand("inspect", "Say whether a mesh is a closed solid, and what is wrong with it");
  add_inspect(*inspect_app, inspect_options);
  StillArguments still;
  auto* fracture_app =
      app.add_subcommand("fracture", "Break one mesh where it stands: one hit, or a plain Voronoi shatter");
  add_fracture(*fracture_app, still);
  auto* extract_app = app.add_subcommand("extract", "Crack surfaces and fragments from any cloud of damaged points");
  add_extract(*extract_app, still);
  batch::BatchOptions batch_options;
  auto* batch_app =
      app.add_subcommand("batch", "Many fractures or scenes: a plan file names what is broken and what varies");
  add_batch(*batch_app, batch_options, log);
  std::string report_folder;
  auto* report_app =
      app.add_subcommand("report", "Write the report page of a run or a batch anew, from the files in its folder");
  report_app->add_option("folder", report_folder, "Folder of the results")->required();
  AccuracyOptions accuracy;
  auto* accuracy_app = app.add_subcommand(
      "accuracy", "Solve the first fracture of a scene at ever finer resolutions: what accuracy costs in time");
  add_accuracy(*accuracy_app, accuracy);
  ValidateOptions validate_options;
  auto* validate_app = app.add_subcommand(
      "validate", "Run the catalogue of validation problems; exit code 0 when every check holds, 1 when one fails");
  add_validate(*validate_app, validate_options);

  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : static_cast<int>(ErrorKind::usage);
  }
  if (*run_app) return run_command(run_arguments, log);
  if (*check_app) return check_command(check);
  if (*fracture_app) return fracture_command(still, log);
  if (*extract_app) return extract_command(still, log);
  if (*batch_app) return batch_command(batch_options, log);
  if (*report_app) return any_report_command(report_folder);
  if (*accuracy_app) return accuracy_command(accuracy);
  if (*validate_app) return validate_command(validate_options);
  return inspect_command(inspect_options);
}

int fail(const LogSettings& log, int code, const std::string& message) {
  if (log.format == LogFormat::json)
    std::cout << nlohmann::ordered_json{{"event", "error"}, {"code", code}, {"message", message}}.dump() << std::endl;
  if (log.progress == ProgressFormat::openjd) std::cout << openjd_failure(message) << std::endl;
  std::cerr << "sunder: " << message << std::endl;
  return code;
}

}  // namespace

int command_line(int argc, char** argv) {
  LogSettings log;
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

}  // namespace sunder::cli
