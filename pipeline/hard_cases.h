#pragma once
/// What `sunder validate` runs: the catalogue, and cases that break simulators: extreme sizes, speeds, materials,
/// meshes and scenes. Each ends finite and conserves what it must, or is refused by an error that names the parameter;
/// never a number that is none, never a hang, never silence.
#include <vector>

#include "validation/problem.h"

namespace sunder::pipeline {

/// The catalogue of validation problems, with those that need whole runs.
const std::vector<validation::Problem>& catalogue();

/// In the order of their ids: S1 and on are those that the numerics call for, X1 and on those that use has taught. A
/// problem's source says what must hold.
const std::vector<validation::Problem>& hard_cases();

}  // namespace sunder::pipeline
