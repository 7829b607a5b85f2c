#pragma once
/// The top-level loop: a scene goes in, a shatter sequence comes out.
#include <filesystem>
#include <functional>
#include <string>

#include "core/progress.h"
#include "output/sequence.h"
#include "pipeline/fracture.h"
#include "pipeline/report.h"
#include "pipeline/scene.h"

namespace sunder::pipeline {

/// A solve that was just settled, for whoever wants more of it than its record.
struct SettledSolve {
  const FractureRecord& record;
  const FractureInput& input;
  const FractureOutcome& outcome;
  const Pose& pose;  ///< of the body when it was hit
};

struct RunOptions {
  std::filesystem::path out;  ///< folder for the results; created when missing
  int threads = 0;            ///< 0: all
  bool predict = false;       ///< say in the report what was expected; takes up to Forecaster::most_seconds
  bool resume = false;        ///< go on from the checkpoint in `out`, if there is one
  std::function<void(const SettledSolve&)> on_solve = [](const SettledSolve&) {};  ///< called after every solve
};

struct RunResult {
  output::Sequence sequence;  ///< empty when the run was complete already
  Report report;
};

/// True when `out` holds the report of a complete run of this scene, by this build.
bool is_complete(const Scene& scene, const std::filesystem::path& out);

/// Bodies move; an impact over the threshold starts a solve of the body that was hit, the step is taken back and
/// repeated with the fragments in its place. Writes what scene.outputs asks for (pipeline/outputs.h), the files of a
/// frame or solve as soon as it is finished, the others at the end, report.json last. Every
/// scene.outputs.checkpoint_interval frames, or later where that would take over 5 % of the time, the state goes to
/// checkpoint.bin, which a complete run removes. When `progress` is cancelled, what was finished and the state are
/// written, report.interrupted is set, and the result returned. A resumed run writes the same bytes as one that was
/// never stopped, times in report.json apart. Errors: ErrorKind::usage for bodies that overlap at the start and those
/// of read_checkpoint, ErrorKind::mesh, ErrorKind::unstable, ErrorKind::io.
RunResult run(const Scene& scene, const RunOptions& options, Progress& progress);

}  // namespace sunder::pipeline
