#pragma once
/// Parts of the catalogue that have a file of their own.
#include <vector>

#include "validation/problem.h"

namespace sunder::validation::detail {

std::vector<Problem> vibration();  ///< A5-A7, A9, A10: waves in bars and beams
std::vector<Problem> machines();   ///< B12-B14: disc, beams, cantilevers that break in testing machines

}  // namespace sunder::validation::detail
