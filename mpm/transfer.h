#pragma once
/// Between particles and grid: APIC transfers (Jiang et al. 2015) with the MLS force of Hu et al. (2018).
#include <vector>

#include "mpm/grid.h"
#include "mpm/particle.h"

namespace sunder::mpm {

/// Particles grouped into slabs of grid planes, so that slabs of one colour never write to the same node: sums have one
/// fixed order whatever the number of threads.
struct SlabOrder {
  static constexpr int planes = 4;  ///< base planes per slab; a stencil reaches two planes further
  std::vector<int> order;           ///< particle indices, slab by slab, in cells within a slab
  std::vector<int> begin;           ///< first entry of each slab in `order`, and the end
};

/// Groups all particles that have not escaped. Requires grid.holds(stencil) for each of them.
SlabOrder slab_order(const std::vector<Particle>& particles, const Grid& grid);

/// Adds mass, m v + affine_momentum (x_i - x_p) of all particles to the grid. Fan (2024) eq. 3.4-3.5 (2.23-2.24 print
/// the opposite sign). `mass` is that of one particle [kg].
void particle_to_grid(const std::vector<Particle>& particles, const SlabOrder& slabs, double mass, Grid& grid);

/// v_p = sum w v_i, C_p = (4/h^2) sum w v_i (x_i - x_p)^T, H += dt C (I + H), u += dt v_p. Requires velocities on the
/// grid. Returns false when a particle left its slab or the grid, so that a new slab_order is needed.
bool grid_to_particle(const Grid& grid, const SlabOrder& slabs, double time_step, std::vector<Particle>& particles);

}  // namespace sunder::mpm
