#include <cmath>
#include <numbers>

#include "core/random.h"
#include "crack/shatter.h"
#include "geometry/mass_properties.h"
#include "geometry/primitives.h"
#include "statistics/laws.h"
#include "statistics/power_law.h"
#include "validation/catalogue.h"
#include "validation/detail/parts.h"

namespace sunder::validation {
namespace {

using namespace statistics;

/// Ascending ln x of a law, x from its standard distribution.
std::vector<double> sample(Law law, const LogPlace& place, std::size_t count) {
  std::vector<double> logs = standard_sample(law, count, 71, 0);
  for (double& z : logs) z = place.location + place.scale * z;
  return logs;
}

/// Of the law that is fitted to a sample: is its KS distance below the critical one of a test at 1 % [sqrt(1/n)]?
double distance_of_fit(Law fitted, const std::vector<double>& logs) {
  return ks_distance(fitted, most_likely(fitted, logs), logs) * std::sqrt(static_cast<double>(logs.size()));
}

/// B16. Least squares on cumulative plots, as often printed, weigh the largest fragments by how many there are above
/// them; the estimators here are those of greatest likelihood.
Outcome estimators() {
  constexpr std::size_t count = 100000;
  // Kolmogorov's critical distance at 1 % is 1.63 / sqrt(n) for a law that was not fitted, and less for one that was.
  constexpr double critical = 1.63;
  Outcome outcome;
  for (const Law law : kLaws) {
    const LogPlace truth{std::log(3e-7), fixed_scale(law).value_or(0.7)};
    const std::vector<double> logs = sample(law, truth, count);
    const LogPlace found = most_likely(law, logs);
    const std::string name(name_of(law));
    outcome.checks.push_back(
        relative(name + ": scale of x, 1e5 values", std::exp(found.location - truth.location), 1, 0.02));
    if (!fixed_scale(law)) outcome.checks.push_back(relative(name + ": exponent", found.scale / truth.scale, 1, 0.02));
    outcome.checks.push_back(
        within(name + ": KS distance of its own sample [sqrt(1/n)]", distance_of_fit(law, logs), 0, critical));
    double nearest = 1e300;
    for (const Law other : kLaws) {
      // Mott's laws are Weibull's with a given shape.
      if (other == law || (other == Law::weibull && fixed_scale(law))) continue;
      nearest = std::min(nearest, distance_of_fit(other, logs));
    }
    outcome.checks.push_back(
        within(name + ": KS distance of the nearest other law [sqrt(1/n)]", nearest, critical, 1e300));
  }
  // n(m) ~ m^-5/3, the universal density of small fragments in three dimensions (Astrom 2004).
  std::vector<double> tail = exponential_sample(20000, 71, 1);
  for (double& x : tail) x /= 5.0 / 3 - 1;
  outcome.checks.push_back(relative("power law: exponent of 2e4 values", best_tail(tail).exponent, 5.0 / 3, 0.02));
  return outcome;
}

/// Poisson-Voronoi cells in a cube: those that do not reach its surface are as in infinite space.
Outcome voronoi_statistics() {
  constexpr std::size_t count = 8000;
  std::vector<Vec3> sites;
  for (std::uint64_t i = 0; i < count; ++i)
    sites.emplace_back(random_unit(4, 0, i), random_unit(4, 1, i), random_unit(4, 2, i));
  SilentProgress progress;
  const auto cells = crack::voronoi_cells(sites, Box(Vec3::Zero(), Vec3::Ones()), 1, progress);
  std::vector<double> volume(count, 0), faces(count, 0);
  std::vector<char> inner(count, 1);
  for (std::size_t i = 0; i < count; ++i) inner[i] = (sites[i] - Vec3::Constant(0.5)).cwiseAbs().maxCoeff() < 0.4;
  for (const auto& face : cells.faces) {
    const auto& loop = face.loop;
    const auto corner = [&](std::size_t k) { return cells.vertices[static_cast<std::size_t>(loop[k])]; };
    double cone = 0;
    for (std::size_t k = 2; k < loop.size(); ++k) cone += corner(0).dot(corner(k - 1).cross(corner(k))) / 6;
    volume[static_cast<std::size_t>(face.inside)] += cone;
    faces[static_cast<std::size_t>(face.inside)] += 1;
    if (face.outside < 0) continue;
    volume[static_cast<std::size_t>(face.outside)] -= cone;
    faces[static_cast<std::size_t>(face.outside)] += 1;
  }
  double n = 0, mean_faces = 0, first = 0, second = 0;
  for (std::size_t i = 0; i < count; ++i) {
    if (!inner[i]) continue;
    n += 1, mean_faces += faces[i], first += volume[i], second += volume[i] * volume[i];
  }
  const double mean = first / n, variation = second / n / (mean * mean) - 1;
  constexpr double pi = std::numbers::pi;
  Outcome outcome;
  outcome.checks = {within("inner cells", n, 3500, 5000),
                    relative("faces of a cell", mean_faces / n, 48 * pi * pi / 35 + 2, 0.03),
                    // The standard error of the variance of 4000 cells is 4 %.
                    relative("squared coefficient of variation of the volume", variation, 0.179, 0.12)};
  return outcome;
}

}  // namespace

std::vector<Problem> size_distributions() {
  return {
      {"B16", "Estimators of fragment size laws", "samples of known laws; Clauset, Shalizi, Newman 2009", estimators},
      {"B16b", "Poisson-Voronoi cells", "48 pi^2/35 + 2 faces (Meijering 1953); volume 0.179", voronoi_statistics}};
}

}  // namespace sunder::validation
