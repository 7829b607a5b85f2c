#pragma once
/// The top-level loop: a scene goes in, a shatter sequence comes out.
#include <filesystem>
#include <functional>
#include <string>

#include "core/progress.h"
#include "pipeline/report.h"
#include "pipeline/scene.h"
#include "pipeline/sequence.h"

namespace sunder::pipeline {

struct RunOptions {
  std::filesystem::path out;  ///< folder for the results; created when missing
  int threads = 0;            ///< 0: all
  std::function<void(const FractureRecord&)> on_fracture = [](const FractureRecord&) {};  ///< called after every solve
};

struct RunResult {
  Sequence sequence;
  Report report;
};

/// Bodies move; an impact over the threshold starts a solve of the body that was hit, the step is taken back and
/// repeated with the fragments in its place. Writes OBJ frames as they are finished, then fragments.glb and
/// report.json. When `progress` is cancelled, what was finished is written, report.interrupted is set, and the result
/// returned. Errors: ErrorKind::usage for bodies that overlap at the start, ErrorKind::mesh, ErrorKind::unstable,
/// ErrorKind::io.
RunResult run(const Scene& scene, const RunOptions& options, Progress& progress);

}  // namespace sunder::pipeline
