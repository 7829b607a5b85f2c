#pragma once
/// What resolution does to the fractures of a scene, and what it costs.
#include <filesystem>
#include <vector>

#include "core/progress.h"

namespace sunder::pipeline {

struct AccuracyOptions {
  std::filesystem::path scene;
  std::filesystem::path out;  ///< folder for accuracy.json, accuracy.html and the pictures; created when missing
  int most_particles = 320000;
  int seeds = 3;  ///< that spread is measured by
  int hits = 1;   ///< of the scene, in the order of time
};

/// Finds the hits that break the scene's bodies while they are whole, solves each at 5000 particles and ever twice as
/// many up to `most_particles`, with quadratic splines and one velocity field, with as many seeds as asked up to a
/// quarter of the finest, and there also with cubic splines and with two velocity fields. Everything is compared with
/// the finest. Prints a table and writes the files. Errors: those of load_scene and Simulation; ErrorKind::usage when
/// nothing breaks; ErrorKind::interrupted (what was measured until then is written); ErrorKind::io.
void measure_accuracy(const AccuracyOptions& options, Progress& progress);

}  // namespace sunder::pipeline
