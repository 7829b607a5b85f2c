#pragma once
/// Samples of known laws.
#include <cmath>
#include <vector>

#include "statistics/laws.h"

namespace sunder::statistics {

/// Ascending values x of a law.
inline std::vector<double> sample_of(Law law, LogPlace place, std::size_t count, std::uint64_t stream) {
  constexpr std::uint64_t kSeed = 71;  // not that of the fits, whose samples these must not repeat
  std::vector<double> values = standard_sample(law, count, kSeed, stream);
  for (double& z : values) z = std::exp(place.location + place.scale * z);
  return values;
}

inline LogPlace example_place(Law law) { return {std::log(3e-7), fixed_scale(law).value_or(0.7)}; }

inline std::vector<double> logarithms_of(std::vector<double> values) {
  for (double& x : values) x = std::log(x);
  return values;
}

}  // namespace sunder::statistics
