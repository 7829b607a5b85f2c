#include "mpm/transfer.h"

#include <algorithm>
#include <atomic>
#include <numeric>

#include <tbb/parallel_for.h>

#include "mpm/quadratic_kernel.h"

namespace sunder::mpm {
namespace {

inline QuadraticStencil stencil_of(const Particle& p, const Grid& grid) {
  return quadratic_stencil(grid.to_cells(p.position()));
}

inline std::array<int, 3> base_of(const Particle& p, const Grid& grid) {
  return quadratic_base(grid.to_cells(p.position()));
}

Node momentum_column(const Mat3& affine, int column, double h) {
  return Node(affine(0, column) * h, affine(1, column) * h, affine(2, column) * h, 0);
}

void scatter(const Particle& p, double mass, Grid& grid) {
  const QuadraticStencil s = stencil_of(p, grid);
  const double h = grid.cell_size();
  const Vec3 to_base(-s.offset[0] * h, -s.offset[1] * h, -s.offset[2] * h);
  const Vec3 at_base = mass * p.velocity + p.affine_momentum * to_base;
  const Node base(at_base[0], at_base[1], at_base[2], mass);
  const Node dx = momentum_column(p.affine_momentum, 0, h), dy = momentum_column(p.affine_momentum, 1, h),
             dz = momentum_column(p.affine_momentum, 2, h);
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) {
      const double wij = s.weight[0][i] * s.weight[1][j];
      const Node row = base + static_cast<double>(i) * dx + static_cast<double>(j) * dy;
      Node* node = &grid.node(grid.index(s.base[0] + static_cast<int>(i), s.base[1] + static_cast<int>(j), s.base[2]));
      node[0] += (wij * s.weight[2][0]) * row;
      node[1] += (wij * s.weight[2][1]) * (row + dz);
      node[2] += (wij * s.weight[2][2]) * (row + 2.0 * dz);
    }
}

void gather(const Grid& grid, double time_step, Particle& p) {
  const QuadraticStencil s = stencil_of(p, grid);
  Node velocity = Node::Zero(), cx = Node::Zero(), cy = Node::Zero(), cz = Node::Zero();
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) {
      const double wij = s.weight[0][i] * s.weight[1][j];
      const Node* node =
          &grid.node(grid.index(s.base[0] + static_cast<int>(i), s.base[1] + static_cast<int>(j), s.base[2]));
      const Node a = (wij * s.weight[2][0]) * node[0], b = (wij * s.weight[2][1]) * node[1],
                 c = (wij * s.weight[2][2]) * node[2];
      const Node sum = a + b + c;
      velocity += sum;
      cx += (static_cast<double>(i) - s.offset[0]) * sum;
      cy += (static_cast<double>(j) - s.offset[1]) * sum;
      cz += b + 2.0 * c - s.offset[2] * sum;
    }
  const double inverse_moment = 1 / (quadratic_moment * grid.cell_size());
  p.velocity = velocity.head<3>();
  p.affine_velocity.col(0) = inverse_moment * cx.head<3>();
  p.affine_velocity.col(1) = inverse_moment * cy.head<3>();
  p.affine_velocity.col(2) = inverse_moment * cz.head<3>();
  const Mat3 increment = time_step * p.affine_velocity;
  p.displacement_gradient += increment + Mat3(increment.lazyProduct(p.displacement_gradient));
  p.displacement += time_step * p.velocity;
}

int slab_of(const std::array<int, 3>& base) { return base[0] / SlabOrder::planes; }

}  // namespace

SlabOrder slab_order(const std::vector<Particle>& particles, const Grid& grid) {
  SlabOrder slabs;
  const std::size_t slab_count = static_cast<std::size_t>(grid.size(0) / SlabOrder::planes + 1);
  std::vector<std::size_t> key(particles.size());
  for (std::size_t p = 0; p < particles.size(); ++p) {
    if (particles[p].escaped) continue;
    const auto base = base_of(particles[p], grid);
    key[p] = grid.index(base[0], base[1], base[2]);
    slabs.order.push_back(static_cast<int>(p));
  }
  std::stable_sort(slabs.order.begin(), slabs.order.end(),
                   [&](int a, int b) { return key[static_cast<std::size_t>(a)] < key[static_cast<std::size_t>(b)]; });
  slabs.begin.assign(slab_count + 1, 0);
  for (int p : slabs.order) {
    const auto base = base_of(particles[static_cast<std::size_t>(p)], grid);
    ++slabs.begin[static_cast<std::size_t>(slab_of(base)) + 1];
  }
  std::partial_sum(slabs.begin.begin(), slabs.begin.end(), slabs.begin.begin());
  return slabs;
}

void particle_to_grid(const std::vector<Particle>& particles, const SlabOrder& slabs, double mass, Grid& grid) {
  const int count = static_cast<int>(slabs.begin.size()) - 1;
  for (int colour = 0; colour < 2; ++colour)
    tbb::parallel_for(0, (count - colour + 1) / 2, [&](int half) {
      const std::size_t slab = static_cast<std::size_t>(2 * half + colour);
      for (int at = slabs.begin[slab]; at < slabs.begin[slab + 1]; ++at)
        scatter(particles[static_cast<std::size_t>(slabs.order[static_cast<std::size_t>(at)])], mass, grid);
    });
}

bool grid_to_particle(const Grid& grid, const SlabOrder& slabs, double time_step, std::vector<Particle>& particles) {
  const int count = static_cast<int>(slabs.begin.size()) - 1;
  std::atomic<bool> in_place = true;
  tbb::parallel_for(0, count, [&](int slab) {
    const std::size_t s = static_cast<std::size_t>(slab);
    for (int at = slabs.begin[s]; at < slabs.begin[s + 1]; ++at) {
      Particle& p = particles[static_cast<std::size_t>(slabs.order[static_cast<std::size_t>(at)])];
      gather(grid, time_step, p);
      const auto base = base_of(p, grid);
      if (!grid.holds(base) || slab_of(base) != slab) in_place.store(false, std::memory_order_relaxed);
    }
  });
  return in_place;
}

}  // namespace sunder::mpm
