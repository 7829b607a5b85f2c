#pragma once
/// What hard cases are made of.
#include <functional>
#include <string>
#include <vector>

#include "core/error.h"
#include "pipeline/fracture.h"
#include "pipeline/run.h"
#include "validation/problem.h"

namespace sunder::pipeline::detail {

std::vector<validation::Problem> hard_solves();  ///< of one body: numerics, materials, sizes, speeds
std::vector<validation::Problem> hard_shapes();  ///< meshes, cracks and cuts
std::vector<validation::Problem> hard_scenes();  ///< whole runs

Material hard_glass();

/// A steel ball of a twentieth of the body's size against the top of the body, a little off its centre.
FractureInput steel_ball_on(const geometry::TriangleMesh& mesh, const Material& material, double speed,
                            int particles = 1500);

/// Breaks it and books what must hold: nothing abandoned, everything finite, pieces closed and as large as the body
/// together, work of the contact within the energy of the impact. Adds its particle-steps.
FractureOutcome sound_fracture(const FractureInput& input, const std::string& what, validation::Outcome& outcome);

/// Holds when `action` throws an Error of this kind whose message contains `word`.
validation::Check refused(const std::string& what, ErrorKind kind, const std::string& word,
                          const std::function<void()>& action);

/// Runs a scene in a scratch folder, with no files but the report, and books what must hold: every pose finite, every
/// fragment closed, volumes kept, and the mechanical energy of what moves never above what there was at the start by
/// more than a hundredth.
RunResult sound_run(const std::string& toml, const std::string& what, validation::Outcome& outcome);

/// Stops the run `stops` times, each time a little later, and goes on; books where the result differs from that of a
/// run that was never stopped.
void stopped_run(const std::string& toml, int stops, validation::Outcome& outcome);

/// Loads a scene for its refusal.
void load_text(const std::string& toml);

}  // namespace sunder::pipeline::detail
