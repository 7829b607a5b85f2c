#include "validation/study.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/resources.h"

namespace sunder::validation {
namespace {

/// Runs that are over at once say little about their time: the least of several says more.
constexpr double enough_seconds = 0.2;
constexpr int most_runs = 20;

Measurement measure_at(const Study& study, int resolution) {
  Measurement m{resolution, 0, 0, std::numeric_limits<double>::infinity()};
  double sum = 0;
  for (int n = 0; n < most_runs && sum < enough_seconds; ++n) {
    const double start = cpu_seconds();
    const StudyPoint point = study.run(resolution);
    const double seconds = cpu_seconds() - start;
    m.error = point.error;
    m.particle_steps = point.particle_steps;
    m.seconds = std::min(m.seconds, seconds);
    sum += seconds;
  }
  return m;
}

}  // namespace

double power_of(const std::vector<double>& x, const std::vector<double>& y) {
  double n = 0, sx = 0, sy = 0, sxx = 0, sxy = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double u = std::log(x[i]), v = std::log(y[i]);
    n += 1, sx += u, sy += v, sxx += u * u, sxy += u * v;
  }
  const double spread = n * sxx - sx * sx, slope = (n * sxy - sx * sy) / spread;
  return std::isfinite(slope) ? slope : std::numeric_limits<double>::quiet_NaN();
}

StudyResult measure(const Study& study, const std::vector<int>& resolutions) {
  StudyResult result;
  std::vector<double> sizes, errors, seconds;
  for (const int resolution : resolutions) {
    const Measurement m = measure_at(study, resolution);
    result.points.push_back(m);
    sizes.push_back(resolution);
    errors.push_back(m.error);
    seconds.push_back(m.seconds);
  }
  result.order = -power_of(sizes, errors);
  result.cost_exponent = -power_of(errors, seconds);
  result.passed = !study.least_order || result.order >= *study.least_order;
  return result;
}

}  // namespace sunder::validation
