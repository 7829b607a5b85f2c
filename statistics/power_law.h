#pragma once
/// Power-law tails, and where they begin. Clauset, Shalizi, Newman, "Power-law distributions in empirical data" (SIAM
/// Review 51, 2009), called CSN here.
#include <cstdint>
#include <span>
#include <vector>

namespace sunder::statistics {

/// Density proportional to x^-exponent for x >= above.
struct PowerLaw {
  double exponent = 0;
  double log_above = 0;   ///< ln of the smallest value in the tail
  std::size_t count = 0;  ///< of the values in the tail
  double ks = 0;          ///< distance of Kolmogorov and Smirnov, of the tail
};

struct TailChoice {
  std::size_t smallest_tail = 10;  ///< fewer values are no tail
  /// Beginnings that are tried. CSN try every value; of more, this many are tried whose tails shrink by equal factors,
  /// so that the short tails, where one value matters, are all tried and the long ones nearly all.
  std::size_t most_candidates = 60;
};

/// The tail whose KS distance from its own most likely power law (CSN eq. 3.1) is least (CSN section 3.3); ties go to
/// the longer tail. `logs`: ln x, ascending, at least smallest_tail of them. count = 0: no tail has two different
/// values.
PowerLaw best_tail(std::span<const double> logs, const TailChoice& choice = {});

/// Of the values x in the tail.
double log_likelihood(const PowerLaw& law, std::span<const double> logs);

/// A data set that the law would give (CSN section 4.1), as ln x, ascending: each of logs.size() values is in the tail
/// with probability count / size and follows the law there, else it is one of the values below, any with equal
/// probability.
std::vector<double> replica(const PowerLaw& law, std::span<const double> logs, std::uint64_t seed,
                            std::uint64_t stream);

}  // namespace sunder::statistics
