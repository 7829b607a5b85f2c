#pragma once
/// The step of the solver written down plainly: dense grid, textbook formulas, iterative eigen solver, one thread. Slow
/// and obviously right: the reference of the tests and the baseline of the benchmark.
#include <array>
#include <cmath>
#include <vector>

#include <Eigen/Dense>

#include "mpm/continuum.h"

namespace sunder::mpm::fixture {

struct ReferencePoint {
  PointState state;
  Motion motion;
  Vec3 position() const { return state.material_position + state.displacement; }
};

/// B-splines of second and third degree; quadratic: Fan (2024) eq. 2.10.
inline double kernel(Spline spline, double distance) {
  const double d = std::abs(distance);
  if (spline == Spline::quadratic) {
    if (d < 0.5) return 0.75 - d * d;
    return d < 1.5 ? 0.5 * (1.5 - d) * (1.5 - d) : 0;
  }
  if (d < 1) return 0.5 * d * d * d - d * d + 2.0 / 3;
  return d < 2 ? (2 - d) * (2 - d) * (2 - d) / 6 : 0;
}

class ReferenceStep {
 public:
  /// `origin` is node (0, 0, 0); the particles must stay at least two cells inside `size` nodes.
  ReferenceStep(const Material& material, double particle_volume, double cell_size, double time_step, double viscosity,
                const Vec3& origin, const std::array<int, 3>& size, Spline spline = Spline::quadratic)
      : material_(material),
        volume_(particle_volume),
        mass_(material.density * particle_volume),
        h_(cell_size),
        dt_(time_step),
        viscosity_(viscosity),
        reach_(spline == Spline::quadratic ? 1.5 : 2),
        moment_(spline == Spline::quadratic ? h_ * h_ / 4 : h_ * h_ / 3),
        spline_(spline),
        origin_(origin),
        size_(size) {}

  /// `kicks`: impulse on each particle [N s], spread to the grid like its momentum; may be empty.
  void operator()(std::vector<ReferencePoint>& particles, const std::vector<Vec3>& kicks = {}) {
    const std::size_t count = static_cast<std::size_t>(size_[0] * size_[1] * size_[2]);
    mass_at_.assign(count, 0);
    momentum_at_.assign(count, Vec3::Zero());
    for (std::size_t p = 0; p < particles.size(); ++p)
      scatter(particles[p], kicks.empty() ? Vec3(Vec3::Zero()) : kicks[p]);
    for (std::size_t n = 0; n < count; ++n)
      if (mass_at_[n] > 1e-290) momentum_at_[n] /= mass_at_[n];
    for (ReferencePoint& p : particles) gather(p);
  }

  /// Cauchy stress after damage and viscosity; grows the damage of the particle.
  Mat3 stress(ReferencePoint& point) const {
    PointState& p = point.state;
    const Mat3& c = point.motion.affine_velocity;
    const Mat3 f = Mat3::Identity() + p.displacement_gradient;
    const double j = f.determinant();
    const Mat3 b = f * f.transpose();
    const Mat3 effective = (material_.shear_modulus() * (b - Mat3::Identity()) +
                            material_.lame_lambda() * std::log(j) * Mat3::Identity()) /
                           j;
    const Eigen::SelfAdjointEigenSolver<Mat3> eigen(effective);
    const double largest = eigen.eigenvalues()[2];
    if (std::isfinite(p.strength) && largest > p.threshold) {
      const double before = p.damage;
      p.damage = std::max(p.damage, std::min(1.0, (1 + p.softening_slope) * (1 - p.strength / largest)));
      const double nu = material_.poisson_ratio, trace = eigen.eigenvalues().sum();
      for (int k = 0; k < 3; ++k)
        if (const double v = eigen.eigenvalues()[k]; v > 0)
          p.dissipated += (p.damage - before) * v * ((1 + nu) * v - nu * trace) / (2 * material_.youngs_modulus);
      p.threshold = largest;
    }
    Mat3 damaged = Mat3::Zero();
    for (int k = 0; k < 3; ++k) {
      const double value = eigen.eigenvalues()[k];
      const Vec3 n = eigen.eigenvectors().col(k);
      damaged += (value > 0 ? (1 - p.damage) * value : value) * n * n.transpose();
    }
    return damaged + 0.5 * viscosity_ * (1 - p.damage) * (c + c.transpose());
  }

 private:
  std::size_t index(int i, int j, int k) const { return static_cast<std::size_t>((i * size_[1] + j) * size_[2] + k); }

  /// Calls visit(node, weight, x_i - x_p) for the nodes within the kernel's reach.
  template <class Visit>
  void for_each_node(const Vec3& x, const Visit& visit) const {
    const Vec3 cells = (x - origin_) / h_;
    const Eigen::Vector3i low = (cells.array() - reach_).ceil().cast<int>();
    const int width = static_cast<int>(2 * reach_);
    for (int i = low[0]; i < low[0] + width; ++i)
      for (int j = low[1]; j < low[1] + width; ++j)
        for (int k = low[2]; k < low[2] + width; ++k) {
          const Vec3 d = Vec3(i, j, k) - cells;
          visit(index(i, j, k), kernel(spline_, d[0]) * kernel(spline_, d[1]) * kernel(spline_, d[2]), Vec3(h_ * d));
        }
  }

  /// Fan (2024) eq. 3.4-3.5: m (v + C d) - dt V0 J sigma d / moment.
  void scatter(ReferencePoint& p, const Vec3& kick) {
    const Mat3 f = Mat3::Identity() + p.state.displacement_gradient;
    const Mat3 kirchhoff = f.determinant() * stress(p);
    for_each_node(p.position(), [&](std::size_t node, double w, const Vec3& d) {
      mass_at_[node] += w * mass_;
      momentum_at_[node] += w * mass_ * (p.motion.velocity + p.motion.affine_velocity * d);
      momentum_at_[node] += -dt_ * volume_ * w * kirchhoff * d / moment_ + w * kick;
    });
  }

  void gather(ReferencePoint& p) const {
    Vec3 v = Vec3::Zero();
    Mat3 c = Mat3::Zero();
    for_each_node(p.position(), [&](std::size_t node, double w, const Vec3& d) {
      v += w * momentum_at_[node];
      c += w / moment_ * momentum_at_[node] * d.transpose();
    });
    p.motion = {v, c};
    const Mat3 f = (Mat3::Identity() + dt_ * c) * (Mat3::Identity() + p.state.displacement_gradient);
    p.state.displacement_gradient = f - Mat3::Identity();
    p.state.displacement += dt_ * v;
  }

  Material material_;
  double volume_, mass_, h_, dt_, viscosity_, reach_, moment_;
  Spline spline_;
  Vec3 origin_;
  std::array<int, 3> size_;
  std::vector<double> mass_at_;
  std::vector<Vec3> momentum_at_;
};

}  // namespace sunder::mpm::fixture
