#include "statistics/power_law.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "core/random.h"

namespace sunder::statistics {
namespace {

// KS distance of a tail (ascending) from the power law of rate = exponent - 1; not exact any more once it is above
// `limit`.
double tail_distance(std::span<const double> tail, double rate, double limit) {
  const double step = 1 / static_cast<double>(tail.size());
  double distance = 0;
  for (std::size_t k = 0; k < tail.size() && distance <= limit; ++k) {
    const double below = -std::expm1(-rate * (tail[k] - tail.front()));
    const double before = static_cast<double>(k) * step;
    distance = std::max({distance, below - before, before + step - below});
  }
  return distance;
}

// Lengths of the tails to try, longest first.
std::vector<std::size_t> tail_lengths(std::size_t count, const TailChoice& choice) {
  std::vector<std::size_t> lengths;
  if (count - choice.smallest_tail < choice.most_candidates) {
    for (std::size_t length = count; length >= choice.smallest_tail; --length) lengths.push_back(length);
    return lengths;
  }
  const double ratio = static_cast<double>(choice.smallest_tail) / static_cast<double>(count);
  for (std::size_t k = 0; k < choice.most_candidates; ++k) {
    const double share = std::pow(ratio, static_cast<double>(k) / static_cast<double>(choice.most_candidates - 1));
    const auto length = static_cast<std::size_t>(std::lround(share * static_cast<double>(count)));
    if (lengths.empty() || length < lengths.back()) lengths.push_back(length);
  }
  return lengths;
}

}  // namespace

PowerLaw best_tail(std::span<const double> logs, const TailChoice& choice) {
  assert(logs.size() >= choice.smallest_tail);
  std::vector<double> sum_from(logs.size() + 1, 0.0);
  for (std::size_t k = logs.size(); k-- > 0;) sum_from[k] = sum_from[k + 1] + (logs[k] - logs.back());
  PowerLaw best;
  best.ks = std::numeric_limits<double>::infinity();
  for (const std::size_t length : tail_lengths(logs.size(), choice)) {
    std::size_t begin = logs.size() - length;
    // A tail holds all values that equal its first.
    while (begin > 0 && logs[begin - 1] == logs[begin]) --begin;
    const std::span<const double> tail = logs.subspan(begin);
    const double n = static_cast<double>(tail.size());
    const double sum = sum_from[begin] - n * (tail.front() - logs.back());
    if (!(tail.front() < tail.back())) break;
    const double rate = n / sum;
    const double distance = tail_distance(tail, rate, best.ks);
    if (distance < best.ks) best = {1 + rate, tail.front(), tail.size(), distance};
  }
  return best;
}

double log_likelihood(const PowerLaw& law, std::span<const double> logs) {
  const double rate = law.exponent - 1;
  double sum = 0;
  for (const double y : logs.last(law.count)) sum += std::log(rate) - rate * (y - law.log_above) - y;
  return sum;
}

std::vector<double> replica(const PowerLaw& law, std::span<const double> logs, std::uint64_t seed,
                            std::uint64_t stream) {
  const std::size_t below = logs.size() - law.count;
  const double share = static_cast<double>(law.count) / static_cast<double>(logs.size());
  std::vector<double> values(logs.size());
  for (std::size_t k = 0; k < logs.size(); ++k) {
    const double u = random_unit(seed, stream, 2 * k + 1);
    if (random_unit(seed, stream, 2 * k) < share) {
      values[k] = law.log_above - std::log1p(-u) / (law.exponent - 1);
    } else {
      values[k] = logs[static_cast<std::size_t>(u * static_cast<double>(below))];
    }
  }
  std::sort(values.begin(), values.end());
  return values;
}

}  // namespace sunder::statistics
