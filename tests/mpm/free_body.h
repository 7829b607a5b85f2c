#pragma once
/// A body that moves by the transfer functions alone, for tests that need no load: elastic or with a stress of their
/// own.
#include <functional>
#include <vector>

#include "mpm/grid.h"
#include "mpm/neo_hookean.h"
#include "mpm/quadratic_kernel.h"
#include "mpm/transfer.h"

namespace sunder::mpm::fixture {

class FreeBody {
 public:
  using Stress = std::function<Mat3(Particle&)>;  ///< Kirchhoff stress
  using Boundary = std::function<void(Grid&)>;    ///< changes the velocities at the nodes

  FreeBody(const std::vector<Vec3>& points, double particle_volume, double density, double cell_size,
           const Vec3& anchor)
      : particles(points.size()),
        mass(density * particle_volume),
        volume_(particle_volume),
        grid(Box(anchor, anchor), cell_size, 4, anchor) {
    for (std::size_t p = 0; p < points.size(); ++p) {
      particles[p].id = static_cast<int>(p);
      particles[p].material_position = points[p];
    }
    sort();
  }

  void step(double time_step, const Stress& stress, const Boundary& boundary = {}) {
    const double h = grid.cell_size();
    grid.clear();
    for (Particle& p : particles)
      p.affine_momentum = mass * p.affine_velocity - time_step * volume_ / (quadratic_moment * h * h) * stress(p);
    particle_to_grid(particles, slabs, mass, grid);
    grid.momentum_to_velocity();
    if (boundary) boundary(grid);
    if (!grid_to_particle(grid, slabs, time_step, particles)) sort();
  }

  Vec3 momentum() const {
    Vec3 sum = Vec3::Zero();
    for (const Particle& p : particles) sum += mass * p.velocity;
    return sum;
  }

  /// Angular momentum about the origin with the part of the affine velocity, m h^2/4 axial(C).
  Vec3 angular_momentum() const {
    Vec3 sum = Vec3::Zero();
    for (const Particle& p : particles) {
      const Mat3& c = p.affine_velocity;
      const Vec3 axial(c(2, 1) - c(1, 2), c(0, 2) - c(2, 0), c(1, 0) - c(0, 1));
      sum +=
          mass * p.position().cross(p.velocity) + mass * quadratic_moment * grid.cell_size() * grid.cell_size() * axial;
    }
    return sum;
  }

  std::vector<Particle> particles;
  double mass;

 private:
  void sort() {
    Box box;
    for (const Particle& p : particles) box.extend(p.position());
    grid = Grid(box, grid.cell_size(), 4, grid.origin());
    slabs = slab_order(particles, grid);
  }

  double volume_;

 public:
  Grid grid;
  SlabOrder slabs;
};

inline Mat3 no_stress(Particle&) { return Mat3::Zero(); }

/// Kirchhoff stress of the neo-Hookean law.
inline FreeBody::Stress elastic(const Material& material) {
  return [law = NeoHookean(material)](Particle& p) -> Mat3 {
    const double dj = volume_change(p.displacement_gradient);
    return (1 + dj) * law.cauchy_stress(p.displacement_gradient, dj);
  };
}

}  // namespace sunder::mpm::fixture
