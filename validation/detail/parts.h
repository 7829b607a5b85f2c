#pragma once
/// Parts of the catalogue that have a file of their own.
#include <vector>

#include "validation/problem.h"

namespace sunder::validation::detail {

std::vector<Problem> vibration();  ///< A5-A7, A9, A10: waves in bars and beams
std::vector<Problem> machines();   ///< B12-B14: disc, beams, cantilevers that break in testing machines

std::vector<Problem> dynamic_cracks();  ///< B8, B9, B11: cracks that turn, branch and twist by themselves
std::vector<Problem> expanding_ring();  ///< B15

}  // namespace sunder::validation::detail
