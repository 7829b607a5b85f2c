#include "statistics/laws.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

#include "core/random.h"

namespace sunder::statistics {
namespace {

double mean(std::span<const double> values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

double deviation(std::span<const double> values, double centre) {
  double sum = 0;
  for (const double v : values) sum += (v - centre) * (v - centre);
  return std::sqrt(sum / static_cast<double>(values.size()));
}

// location = scale ln(mean of exp(ln x / scale)), summed from the largest value so that nothing overflows.
double weibull_location(std::span<const double> logs, double scale) {
  double sum = 0;
  for (const double y : logs) sum += std::exp((y - logs.back()) / scale);
  return logs.back() + scale * std::log(sum / static_cast<double>(logs.size()));
}

// The shape k of greatest likelihood solves sum(y e^(k y)) / sum(e^(k y)) - 1 / k = mean(y), y = ln x (Cohen 1965). The
// left side grows with k, its derivative is the weighted variance of y plus 1 / k^2, so the root is the only one; a
// step that leaves its bracket is replaced by halving.
LogPlace most_likely_weibull(std::span<const double> logs) {
  constexpr int kMostSteps = 60;
  constexpr double kTolerance = 1e-12;  // relative: far below any interval of k
  const double centre = mean(logs), top = logs.back();
  double low = 0, high = std::numeric_limits<double>::infinity();
  // Deviation of ln x is pi / (sqrt(6) k).
  double shape = std::numbers::pi / std::sqrt(6.0) / deviation(logs, centre);
  for (int step = 0; step < kMostSteps; ++step) {
    double s0 = 0, s1 = 0, s2 = 0;
    for (const double y : logs) {
      const double d = y - top, weight = std::exp(shape * d);
      s0 += weight;
      s1 += weight * d;
      s2 += weight * d * d;
    }
    const double first = s1 / s0;
    const double value = first - 1 / shape - (centre - top);
    (value > 0 ? high : low) = shape;
    double next = shape - value / (s2 / s0 - first * first + 1 / (shape * shape));
    if (!(next > low && next < high)) next = std::isinf(high) ? 2 * shape : (low + high) / 2;
    const bool done = std::abs(next - shape) <= kTolerance * shape;
    shape = next;
    if (done) break;
  }
  return {weibull_location(logs, 1 / shape), 1 / shape};
}

std::vector<double> normal_sample(std::size_t count, std::uint64_t seed, std::uint64_t stream) {
  std::vector<double> values;
  values.reserve(count + 1);
  for (std::size_t k = 0; k < count; k += 2) {  // Box and Muller 1958
    const double radius = std::sqrt(-2 * std::log1p(-random_unit(seed, stream, k)));
    const double angle = 2 * std::numbers::pi * random_unit(seed, stream, k + 1);
    values.push_back(radius * std::cos(angle));
    values.push_back(radius * std::sin(angle));
  }
  values.resize(count);
  std::sort(values.begin(), values.end());
  return values;
}

}  // namespace

std::string_view name_of(Law law) {
  constexpr std::array<std::string_view, kLaws.size()> kNames = {"mott_2d", "mott_3d", "weibull", "log_normal",
                                                                 "gaudin_schuhmann"};
  return kNames[static_cast<std::size_t>(law)];
}

std::optional<double> fixed_scale(Law law) {
  if (law == Law::mott_2d) return 2;
  if (law == Law::mott_3d) return 3;
  return {};
}

double standard_cdf(Law law, double z) {
  if (law == Law::log_normal) return std::erfc(-z / std::numbers::sqrt2) / 2;
  if (law == Law::gaudin_schuhmann) return std::exp(std::min(z, 0.0));
  return -std::expm1(-std::exp(z));
}

double standard_log_density(Law law, double z) {
  if (law == Law::log_normal) return -(z * z + std::log(2 * std::numbers::pi)) / 2;
  if (law == Law::gaudin_schuhmann) return z <= 0 ? z : -std::numeric_limits<double>::infinity();
  return z - std::exp(z);
}

std::vector<double> exponential_sample(std::size_t count, std::uint64_t seed, std::uint64_t stream) {
  std::vector<double> values(count);
  double sum = 0;
  for (std::size_t k = 0; k < count; ++k) {
    sum -= std::log1p(-random_unit(seed, stream, k)) / static_cast<double>(count - k);
    values[k] = sum;
  }
  return values;
}

std::vector<double> standard_sample(Law law, std::size_t count, std::uint64_t seed, std::uint64_t stream) {
  if (law == Law::log_normal) return normal_sample(count, seed, stream);
  std::vector<double> values = exponential_sample(count, seed, stream);
  if (law == Law::gaudin_schuhmann) {
    std::reverse(values.begin(), values.end());
    for (double& z : values) z = -z;
  } else {
    // A draw of exactly 0 (one in 2^53) has no logarithm.
    for (double& z : values) z = std::log(std::max(z, std::numeric_limits<double>::min()));
  }
  return values;
}

LogPlace most_likely(Law law, std::span<const double> logs) {
  assert(logs.size() >= 2 && logs.front() < logs.back());
  if (const auto scale = fixed_scale(law)) return {weibull_location(logs, *scale), *scale};
  if (law == Law::weibull) return most_likely_weibull(logs);
  const double centre = mean(logs);
  if (law == Law::log_normal) return {centre, deviation(logs, centre)};
  return {logs.back(), logs.back() - centre};
}

double log_likelihood(Law law, LogPlace place, std::span<const double> logs) {
  double sum = -static_cast<double>(logs.size()) * std::log(place.scale);
  for (const double y : logs) sum += standard_log_density(law, (y - place.location) / place.scale) - y;
  return sum;
}

double ks_distance(Law law, LogPlace place, std::span<const double> logs) {
  const double step = 1 / static_cast<double>(logs.size());
  double distance = 0;
  for (std::size_t k = 0; k < logs.size(); ++k) {
    const double below = standard_cdf(law, (logs[k] - place.location) / place.scale);
    const double before = static_cast<double>(k) * step;
    distance = std::max({distance, below - before, before + step - below});
  }
  return distance;
}

}  // namespace sunder::statistics
