#pragma once
/// Laws of sizes fitted to a sample, with what the fit is worth: intervals, a test, and the likelihood.
///
/// Both intervals and p-value come from samples drawn anew. For the laws of statistics/laws.h the distributions of
/// (location^ - location) / scale^, scale^ / scale and of the KS distance after fitting depend on nothing but the law
/// and the count (Antle, Bain 1969; David, Johnson 1948), so samples of the standard law give exact intervals and an
/// exact test, up to the finite number of samples. The table of Kolmogorov's distribution would be wrong here: it is
/// for laws that were not fitted to the data, and its p-values would be far too large (Lilliefors 1967).
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "statistics/laws.h"

namespace sunder::statistics {

struct Parameter {
  std::string name;
  double value = 0;
  double low = 0, high = 0;  ///< the interval that holds the true value with the probability FitSettings::confidence
};

struct Fit {
  std::string law;                    ///< name_of(Law) or "power_law"
  std::size_t count = 0;              ///< of the values that it was fitted to
  std::vector<Parameter> parameters;  ///< by the names and in the units of Law
  double ks = 0;                      ///< distance of Kolmogorov and Smirnov
  double p_value = 0;                 ///< probability of a distance at least as large if the law holds
  double log_likelihood = 0;          ///< of the values that it was fitted to, of densities in 1 / unit of x
  /// Akaike 1974; lower is better among fits to the same values. Not set for a power law: the values it speaks of were
  /// chosen by how well it fits them.
  std::optional<double> aic;
  std::optional<double> above;  ///< smallest value that it was fitted to; not set: all
};

struct FitSettings {
  int samples = 499;         ///< drawn for intervals and test: a p-value of 0.05 has a standard error of 0.01
  double confidence = 0.95;  ///< of the intervals
  std::uint64_t seed = 2009;
  /// Below this the intervals of a second parameter span a factor of 2 and the test rejects next to nothing.
  std::size_t smallest_sample = 10;
  /// Clauset, Shalizi, Newman 2009: with fewer values neither the exponent nor where the tail begins can be trusted.
  std::size_t smallest_power_law_sample = 50;
};

/// Every law to the same values (x > 0, any order) in the order of Law, the power law last. Laws that have too few
/// values are left out, all of them if the values are all the same. A pure function.
std::vector<Fit> fit_laws(std::span<const double> values, const FitSettings& settings = {});

/// The law with the lowest AIC of those that speak of all values, without intervals and tests; nothing where fit_laws
/// fits none.
std::optional<Law> best_law(std::span<const double> values, const FitSettings& settings = {});

}  // namespace sunder::statistics
