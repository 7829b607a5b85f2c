#pragma once
/// Bodies, materials and loads that the tests of the solver share.
#include <cmath>
#include <functional>
#include <vector>

#include "core/random.h"
#include "mpm/solve.h"

namespace sunder::mpm::fixture {

struct Body {
  std::vector<Vec3> points;
  double volume = 0;
};

/// Lattice of the given spacing, symmetric about the origin, kept where `inside` holds. `jitter` in spacings.
inline Body fill(const Vec3& half_size, double spacing, const std::function<bool(const Vec3&)>& inside,
                 double jitter = 0) {
  Body body;
  const Vec3 cells = (half_size / spacing).array().round().max(1);
  std::uint64_t n = 0;
  for (double i = 0.5 - cells[0]; i < cells[0]; ++i)
    for (double j = 0.5 - cells[1]; j < cells[1]; ++j)
      for (double k = 0.5 - cells[2]; k < cells[2]; ++k) {
        const Vec3 x = spacing * Vec3(i, j, k);
        if (!inside(x)) continue;
        const Vec3 shift(random_unit(1, 0, n), random_unit(1, 1, n), random_unit(1, 2, n));
        body.points.push_back(x + jitter * spacing * (2 * shift - Vec3::Ones()));
        ++n;
      }
  body.volume = static_cast<double>(body.points.size()) * spacing * spacing * spacing;
  return body;
}

inline Body block(const Vec3& half_size, double spacing, double jitter = 0) {
  return fill(
      half_size, spacing, [](const Vec3&) { return true; }, jitter);
}

/// 10 x 2 x 10 cm, 3125 points at the default spacing, jittered so that cracks do not follow the lattice.
inline Body plate(double spacing = 0.004, double jitter = 0.25) {
  return fill(
      {0.05, 0.01, 0.05}, spacing, [](const Vec3&) { return true; }, jitter);
}

/// Diameter 10 cm; about 3000 points at the default spacing.
inline Body sphere(double spacing = 0.0056, double jitter = 0.25) {
  return fill(
      Vec3::Constant(0.05), spacing, [](const Vec3& x) { return x.norm() < 0.05; }, jitter);
}

/// Open towards +Y, 10 cm high, 8 cm wide, wall 1 cm; about 3200 points at the default spacing.
inline Body cup(double spacing = 0.0045, double jitter = 0.25) {
  const auto inside = [](const Vec3& x) {
    const double r = std::hypot(x[0], x[2]);
    return r < 0.04 && (r > 0.03 || x[1] < -0.04);
  };
  return fill({0.04, 0.05, 0.04}, spacing, inside, jitter);
}

inline Material glass() {
  return {.density = 2500,
          .youngs_modulus = 70e9,
          .poisson_ratio = 0.22,
          .tensile_strength = 40e6,
          .fracture_energy = 8,
          .weibull_modulus = 8};
}

/// Glass that nothing breaks.
inline Material sound_glass() {
  Material m = glass();
  m.tensile_strength = 1e15;
  m.fracture_energy = 1e15;
  return m;
}

/// Soft and light enough that a contact lasts tens of milliseconds.
inline Material rubber() {
  return {.density = 1000,
          .youngs_modulus = 1e6,
          .poisson_ratio = 0.3,
          .tensile_strength = 1e12,
          .fracture_energy = 1e12,
          .weibull_modulus = 0};
}

/// A steel ball of the given radius [m].
inline double steel_ball_mass(double radius) { return 7850 * 4.0 / 3 * 3.14159265358979 * radius * radius * radius; }

/// That ball against a flat or round (radius of curvature) face of glass.
inline Load steel_ball_on_glass(const Vec3& point, const Vec3& outward, double speed, double ball_radius = 0.01,
                                double face_radius = std::numeric_limits<double>::infinity()) {
  Load load;
  load.point = point;
  load.outward = outward;
  load.approach_speed = speed;
  load.pair = {1 / (1 / ball_radius + 1 / face_radius), effective_modulus(70e9, 0.22, 210e9, 0.3), 5.5e9};
  return load;
}

inline Vec3 momentum(const SolveResult& r) {
  Vec3 sum = Vec3::Zero();
  for (const ParticleState& p : r.particles) sum += r.particle_mass * p.velocity;
  return sum;
}

/// About the origin, with the spin of the affine velocities.
inline Vec3 angular_momentum(const std::vector<Vec3>& points, const SolveResult& r) {
  Vec3 sum = Vec3::Zero();
  for (std::size_t p = 0; p < points.size(); ++p)
    sum += r.particle_mass * (points[p] + r.particles[p].displacement).cross(r.particles[p].velocity) +
           r.particles[p].spin_momentum;
  return sum;
}

/// Share of all particles that are damaged and further than `depth` from every sound one: lumps instead of bands.
inline double lump_share(const std::vector<Vec3>& points, const SolveResult& r, double depth) {
  std::size_t lumps = 0;
  for (std::size_t p = 0; p < points.size(); ++p) {
    if (r.particles[p].damage < 0.95) continue;
    bool deep = true;
    for (std::size_t q = 0; deep && q < points.size(); ++q)
      deep = r.particles[q].damage >= 0.95 || (points[p] - points[q]).squaredNorm() > depth * depth;
    lumps += deep;
  }
  return static_cast<double>(lumps) / static_cast<double>(points.size());
}

inline SolveResult run(const Body& body, const Material& material, const std::vector<Load>& loads,
                       const std::vector<Partner>& partners, const SolveSettings& settings = {}) {
  SilentProgress progress;
  return solve({body.points, body.volume, material, loads, partners}, settings, progress);
}

}  // namespace sunder::mpm::fixture
