#pragma once
/// A body without loads, stepped with its motion in the open: start, grid, finish. The same arithmetic as the fused
/// step.
#include <vector>

#include "mpm/continuum.h"
#include "tests/mpm/bodies.h"

namespace sunder::mpm::fixture {

struct FreeBody {
  FreeBody(const std::vector<Vec3>& points, double particle_volume, const Material& material,
           const ContinuumSettings& settings)
      : body(points, particle_volume, material, settings), motion(points.size()) {}

  void step() {
    body.start(motion);
    body.update_grid();
    motion = body.finish();
  }

  Continuum body;
  std::vector<Motion> motion;
};

inline ContinuumSettings continuum_settings(double cell_size, double time_step, const Vec3& anchor,
                                            Spline spline = Spline::quadratic) {
  ContinuumSettings settings;
  settings.cell_size = cell_size;
  settings.time_step = time_step;
  settings.anchor = anchor;
  settings.spline = spline;
  return settings;
}

/// Mass without stiffness.
inline Material dust(double density) { return {.density = density}; }

inline Mat3 spin_matrix(const Vec3& w) {
  Mat3 m;
  m << 0, -w[2], w[1], w[2], 0, -w[0], -w[1], w[0], 0;
  return m;
}

}  // namespace sunder::mpm::fixture
