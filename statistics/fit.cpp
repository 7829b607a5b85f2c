#include "statistics/fit.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "statistics/power_law.h"

namespace sunder::statistics {
namespace {

struct Interval {
  double low = 0, high = 0;
};

// The values that leave (1 - confidence) / 2 of the sample outside on either side. With 499 values and 95 % these are
// the 13th from either end: position share * (count + 1), the unbiased one.
Interval middle(std::vector<double> sample, double confidence) {
  std::sort(sample.begin(), sample.end());
  const double position = (1 - confidence) / 2 * static_cast<double>(sample.size() + 1);
  const std::size_t outside = static_cast<std::size_t>(std::max(1L, std::lround(position))) - 1;
  return {sample[outside], sample[sample.size() - 1 - outside]};
}

// Davison, Hinkley 1997, eq. 4.11: the data count as one of the samples, so it is never 0.
double p_value(const std::vector<double>& distances, double distance) {
  const auto worse = std::count_if(distances.begin(), distances.end(), [&](double d) { return d >= distance; });
  return static_cast<double>(worse + 1) / static_cast<double>(distances.size() + 1);
}

/// What fits to samples of the standard law give: none of it depends on where the data are.
struct Pivots {
  std::vector<double> location;  // location^ / scale^
  std::vector<double> scale;     // scale^
  std::vector<double> ks;
};

Pivots pivots(Law law, std::size_t count, const FitSettings& settings) {
  Pivots result;
  for (int k = 0; k < settings.samples; ++k) {
    std::vector<double> sample =
        standard_sample(law, count, settings.seed + static_cast<std::uint64_t>(law), static_cast<std::uint64_t>(k));
    if (const auto scale = fixed_scale(law))
      for (double& z : sample) z *= *scale;
    const LogPlace place = most_likely(law, sample);
    result.location.push_back(place.location / place.scale);
    result.scale.push_back(place.scale);
    result.ks.push_back(ks_distance(law, place, sample));
  }
  return result;
}

Parameter exponential_of(const std::string& name, double value, const Interval& interval) {
  return {name, std::exp(value), std::exp(interval.low), std::exp(interval.high)};
}

Parameter inverse_of(const std::string& name, double value, const Interval& interval) {
  return {name, 1 / value, 1 / interval.high, 1 / interval.low};
}

std::vector<Parameter> parameters(Law law, const LogPlace& place, const Pivots& pivot, double confidence) {
  const Interval shift = middle(pivot.location, confidence), stretch = middle(pivot.scale, confidence);
  const Interval location{place.location - place.scale * shift.high, place.location - place.scale * shift.low};
  const Interval scale{place.scale / stretch.high, place.scale / stretch.low};
  switch (law) {
    case Law::mott_2d:
    case Law::mott_3d:
      return {exponential_of("mu", place.location, location)};
    case Law::weibull:
      return {exponential_of("scale", place.location, location), inverse_of("shape", place.scale, scale)};
    case Law::log_normal:
      return {{"mu", place.location, location.low, location.high}, {"sigma", place.scale, scale.low, scale.high}};
    case Law::gaudin_schuhmann:
      return {exponential_of("maximum", place.location, location), inverse_of("exponent", place.scale, scale)};
  }
  return {};
}

double akaike(Law law, const LogPlace& place, std::span<const double> logs) {
  return (fixed_scale(law) ? 2 : 4) - 2 * log_likelihood(law, place, logs);
}

Fit fit_law(Law law, std::span<const double> logs, const FitSettings& settings) {
  const LogPlace place = most_likely(law, logs);
  const Pivots pivot = pivots(law, logs.size(), settings);
  Fit fit;
  fit.law = name_of(law);
  fit.count = logs.size();
  fit.parameters = parameters(law, place, pivot, settings.confidence);
  fit.ks = ks_distance(law, place, logs);
  fit.p_value = p_value(pivot.ks, fit.ks);
  fit.log_likelihood = log_likelihood(law, place, logs);
  fit.aic = akaike(law, place, logs);
  return fit;
}

std::optional<Fit> fit_power_law(std::span<const double> logs, const FitSettings& settings) {
  const PowerLaw law = best_tail(logs);
  if (law.count == 0) return {};
  std::vector<double> rate, above, distances;
  for (int k = 0; k < settings.samples; ++k) {
    const PowerLaw again = best_tail(replica(law, logs, settings.seed, static_cast<std::uint64_t>(k)));
    assert(again.count > 0);
    rate.push_back((again.exponent - 1) / (law.exponent - 1));
    above.push_back(again.log_above);
    distances.push_back(again.ks);
  }
  const Interval ratio = middle(rate, settings.confidence);
  Fit fit;
  fit.law = "power_law";
  fit.count = law.count;
  fit.parameters = {{"exponent", law.exponent, 1 + (law.exponent - 1) / ratio.high, 1 + (law.exponent - 1) / ratio.low},
                    exponential_of("above", law.log_above, middle(above, settings.confidence))};
  fit.ks = law.ks;
  fit.p_value = p_value(distances, law.ks);
  fit.log_likelihood = log_likelihood(law, logs);
  fit.above = std::exp(law.log_above);
  return fit;
}

// Ascending; empty when there is nothing to fit.
std::vector<double> logarithms(std::span<const double> values, const FitSettings& settings) {
  std::vector<double> logs;
  for (const double x : values) {
    assert(x > 0);
    logs.push_back(std::log(x));
  }
  std::sort(logs.begin(), logs.end());
  if (logs.size() < std::max<std::size_t>(2, settings.smallest_sample) || logs.front() == logs.back()) return {};
  return logs;
}

}  // namespace

std::vector<Fit> fit_laws(std::span<const double> values, const FitSettings& settings) {
  const std::vector<double> logs = logarithms(values, settings);
  std::vector<Fit> fits;
  if (logs.empty()) return fits;
  for (const Law law : kLaws) fits.push_back(fit_law(law, logs, settings));
  if (logs.size() >= settings.smallest_power_law_sample)
    if (auto fit = fit_power_law(logs, settings)) fits.push_back(std::move(*fit));
  return fits;
}

std::optional<Law> best_law(std::span<const double> values, const FitSettings& settings) {
  const std::vector<double> logs = logarithms(values, settings);
  if (logs.empty()) return {};
  const auto aic = [&](Law law) { return akaike(law, most_likely(law, logs), logs); };
  return *std::min_element(kLaws.begin(), kLaws.end(), [&](Law a, Law b) { return aic(a) < aic(b); });
}

}  // namespace sunder::statistics
