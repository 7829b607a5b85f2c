#pragma once
/// The state of a run on disk, from which another run goes on to the same results.
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "pipeline/simulation.h"

namespace sunder::pipeline {

struct Checkpoint {
  int steps = 0;  ///< taken since the last frame
  rigid::World::State world;
  SimulationState simulation;
};

/// Replaces the file in one go: whoever reads it finds the old checkpoint or the new one, whole. Errors: ErrorKind::io.
void write_checkpoint(const std::filesystem::path& file, const std::string& scene_fingerprint, int steps,
                      const Simulation& simulation);

/// Nothing when there is no such file. Errors: ErrorKind::io for a file that is damaged or no checkpoint,
/// ErrorKind::usage for one of another scene or of another build of the program.
std::optional<Checkpoint> read_checkpoint(const std::filesystem::path& file, const std::string& scene_fingerprint);

}  // namespace sunder::pipeline
