#pragma once
/// The parts of the catalogue, a source file each.
#include <vector>

#include "validation/problem.h"

namespace sunder::validation {

std::vector<Problem> elasticity();          ///< A: transfers, elasticity, impact
std::vector<Problem> damage();              ///< B1-B4: the damage law
std::vector<Problem> fracture();            ///< B5 and on: cracks
std::vector<Problem> size_distributions();  ///< B16: the laws of fragment sizes
std::vector<Problem> surfaces();            ///< C: crack surfaces and cuts
std::vector<Problem> rigid_bodies();        ///< D: how bodies move
std::vector<Problem> contact();             ///< D: bodies and crack faces that touch

}  // namespace sunder::validation
