#pragma once
/// The files that a run leaves, beside report.json and the page made of it. docs/outputs.md describes each.
#include <filesystem>
#include <string>
#include <vector>

#include "output/sequence.h"
#include "output/writers.h"
#include "pipeline/report.h"
#include "pipeline/run.h"
#include "pipeline/scene.h"

namespace sunder::pipeline {

/// Files of one kind that a run will write.
struct PlannedFiles {
  std::string name;  ///< with #### where a frame number will stand
  int count = 1;     ///< 0: as many as there are solves
};

/// What the scene asks for, in the order in which it is written.
std::vector<PlannedFiles> planned_files(const Scene& scene);

/// The files that come one a frame, for the newest frame of the sequence. `obj` has written the frames before, or none.
/// Errors: ErrorKind::io.
void write_newest_frame(const Scene& scene, const output::Sequence& sequence, const std::filesystem::path& folder,
                        output::ObjFrames& obj);

/// vdb/<piece>.####.vdb, by the number of the first frame that shows what the solve did. Errors: ErrorKind::io.
void write_solve(const Scene& scene, const SettledSolve& solve, const std::filesystem::path& folder);

/// The files that hold the whole run. Errors: ErrorKind::io.
void write_whole_run(const Scene& scene, const output::Sequence& sequence, const std::filesystem::path& folder);

/// Frames of an earlier, longer run would play on after the end of this one, and its solves are not this one's.
void remove_stale_files(const Scene& scene, const Report& report, const std::filesystem::path& folder);

}  // namespace sunder::pipeline
