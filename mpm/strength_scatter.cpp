#include "mpm/strength_scatter.h"

#include <cmath>
#include <numbers>

#include "core/random.h"
#include "mpm/spline.h"

namespace sunder::mpm {
namespace {

constexpr std::uint64_t scatter_stream = 0x5ca77e2;

std::uint64_t lattice_key(int i, int j, int k) {
  const auto part = [](int n) { return static_cast<std::uint64_t>(static_cast<std::uint32_t>(n)) & 0x1FFFFF; };
  return part(i) << 42 | part(j) << 21 | part(k);
}

/// Box and Muller (1958).
double normal_deviate(std::uint64_t seed, std::uint64_t key) {
  const double u = 1 - random_unit(seed, scatter_stream, 2 * key), v = random_unit(seed, scatter_stream, 2 * key + 1);
  return std::sqrt(-2 * std::log(u)) * std::cos(2 * std::numbers::pi * v);
}

/// Quadratic B-splines blend the 27 lattice points around x.
double gaussian_field(const Vec3& x, std::uint64_t seed) {
  const Vec3 low = (x.array() - stencil_shift(Spline::quadratic)).floor();
  double weight[3][4];
  for (int a = 0; a < 3; ++a) spline_weights(Spline::quadratic, x[a] - low[a] - 1, weight[a]);
  double sum = 0, squares = 0;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      for (int k = 0; k < 3; ++k) {
        const double w = weight[0][i] * weight[1][j] * weight[2][k];
        const auto at = [&](int axis, int n) { return static_cast<int>(low[axis]) + n; };
        sum += w * normal_deviate(seed, lattice_key(at(0, i), at(1, j), at(2, k)));
        squares += w * w;
      }
  return sum / std::sqrt(squares);
}

}  // namespace

std::vector<double> strength_scatter(const std::vector<Vec3>& points, double modulus, double correlation_length,
                                     std::uint64_t seed) {
  std::vector<double> factors(points.size(), 1.0);
  if (modulus <= 0) return factors;
  const double mean = std::tgamma(1 + 1 / modulus);
  for (std::size_t p = 0; p < points.size(); ++p) {
    const double g = gaussian_field(points[p] / correlation_length, seed);
    // 0.5 erfc(x) is the probability of failure; far tails are cut where a double no longer resolves them.
    const double survival = std::clamp(0.5 * std::erfc(g / std::numbers::sqrt2), 1e-12, 1 - 1e-12);
    factors[p] = std::pow(-std::log(survival), 1 / modulus) / mean;
  }
  return factors;
}

}  // namespace sunder::mpm
