#pragma once
/// The commands that take a scene: `run` and `check`.
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/progress_display.h"
#include "pipeline/report.h"
#include "pipeline/scene.h"

namespace sunder::pipeline {

struct RunArguments {
  std::string scene, out, frames;
  std::optional<Quality> quality;
  std::optional<double> time_budget;  ///< [s]
  std::optional<std::uint64_t> seed;
  std::vector<Override> overrides;
  int threads = 0;
  bool resume = false, dry_run = false;
  bool predict = true;  ///< say in the report what was expected
};

/// Simulates, or with `dry_run` says what would be simulated and written. Returns the exit code. Errors: those of
/// load_scene and run; ErrorKind::usage for `frames` that are no range of the scene's, ErrorKind::io for a dry run into
/// a folder that cannot be written.
int run_command(const RunArguments& arguments, const LogSettings& log);

struct CheckArguments {
  std::string scene;
  std::vector<Override> overrides;
  std::optional<Quality> quality;
  std::optional<double> time_budget;  ///< [s]
  int threads = 0;
  bool json = false;
};

/// Says which effects will run, what repair does to the meshes, and what a run will take. Errors: those of load_scene
/// and of placing the bodies.
int check_command(const CheckArguments& arguments);

/// One line for the terminal.
std::string sentence(const FractureRecord& record);

}  // namespace sunder::pipeline
