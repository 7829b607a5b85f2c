#pragma once
/// Laws of fragment sizes. All of them are location-scale families of ln x: ln x = location + scale z, where z has the
/// law's standard distribution. What follows from that alone (estimates that move with the data, exact intervals,
/// tests) is written once (statistics/fit.h). docs/statistics.md gives every law with its source.
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace sunder::statistics {

/// Share P of the fragments that are larger than x; E is a standard exponential variable.
enum class Law {
  mott_2d,           ///< P = exp(-(x / mu)^(1/2)), Mott 1947: ln x = ln mu + 2 ln E
  mott_3d,           ///< P = exp(-(x / mu)^(1/3)): ln x = ln mu + 3 ln E
  weibull,           ///< P = exp(-(x / scale)^shape), Weibull 1951: ln x = ln scale + ln E / shape
  log_normal,        ///< ln x = mu + sigma z, z normal, Kolmogorov 1941
  gaudin_schuhmann,  ///< P = 1 - (x / maximum)^exponent up to the maximum: ln x = ln maximum - E / exponent
};

inline constexpr std::array kLaws = {Law::mott_2d, Law::mott_3d, Law::weibull, Law::log_normal, Law::gaudin_schuhmann};

/// "mott_2d".
std::string_view name_of(Law law);

/// Member of a law's family: of ln x, for x in the unit of the data.
struct LogPlace {
  double location = 0, scale = 1;
};

/// 2 or 3 for Mott's laws; not set: the data decide it.
std::optional<double> fixed_scale(Law law);

/// Of z: probability of being at most z, and the logarithm of the density.
double standard_cdf(Law law, double z);
double standard_log_density(Law law, double z);

/// `count` independent values of z in ascending order; a pure function of its arguments.
std::vector<double> standard_sample(Law law, std::size_t count, std::uint64_t seed, std::uint64_t stream);

/// The order statistics of `count` standard exponential variables, ascending, made from their independent spacings
/// (Renyi 1953), without a sort. Takes words [0, count) of the stream.
std::vector<double> exponential_sample(std::size_t count, std::uint64_t seed, std::uint64_t stream);

/// The place of greatest likelihood for ascending values of ln x, at least two of them different. Weibull's shape is
/// the root of the profile likelihood by Newton's method; all others have closed forms.
LogPlace most_likely(Law law, std::span<const double> logs);

/// Of the values x themselves, so in units of 1 / x each: only differences between laws mean anything.
double log_likelihood(Law law, LogPlace place, std::span<const double> logs);

/// Largest difference between the share of the (ascending) values that are at most x and the law's, Kolmogorov 1933.
double ks_distance(Law law, LogPlace place, std::span<const double> logs);

}  // namespace sunder::statistics
