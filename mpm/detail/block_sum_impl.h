#pragma once
/// The sum over the tiles of a block, for the instruction set that the including file is compiled for.
#include "mpm/block_pass.h"
#include "mpm/detail/lanes.h"

namespace sunder::mpm {
namespace {

template <class S>
inline void add_tiles(const Node* const tile[8], Quad total[block_nodes]) {
  constexpr int edge = tile_edge(S::name), above = edge - block_edge;
  for (int n = 0; n < block_nodes; ++n) total[n] = Quad{};
  for (int x = 0; x < 2; ++x)
    for (int y = 0; y < 2; ++y)
      for (int z = 0; z < 2; ++z) {
        const Node* from = tile[4 * x + 2 * y + z];
        if (!from) continue;
        const int nx = x ? above : block_edge, ny = y ? above : block_edge, nz = z ? above : block_edge;
        for (int i = 0; i < nx; ++i)
          for (int j = 0; j < ny; ++j) {
            const Node* row = from + ((i + block_edge * x) * edge + j + block_edge * y) * edge + block_edge * z;
            for (int k = 0; k < nz; ++k) total[(i * block_edge + j) * block_edge + k] += load_quad(row[k].value);
          }
      }
}

/// Weights go to zero smoothly, so a node can hold a mass whose inverse is not finite.
inline bool has_mass(Quad momentum) { return momentum[3] > 1e-290; }

inline Quad velocity_of(Quad momentum) {
  Quad v = has_mass(momentum) ? momentum / momentum[3] : Quad{};
  v[3] = momentum[3];
  return v;
}

inline double dot(Quad a, Quad b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

/// Contact of the two fields of a node across a crack plane: where they approach, they get a common normal velocity,
/// and friction takes at most `friction` times that change from their sliding. Bardenhagen et al. (2000); Fan (2024)
/// eq. 3.7 prints the sign of separation and eq. 3.6 a normal that is not a unit vector.
inline void make_contact(Quad n, double friction, Quad& first, Quad& second) {
  const double m1 = first[3], m2 = second[3], reduced = m1 * m2 / (m1 + m2);
  n[3] = 0;
  Quad relative = first - second;
  relative[3] = 0;
  const double approach = -dot(relative, n);
  if (approach <= 0) return;
  // Impulse on the first field: along the normal, and against the sliding.
  const Quad slide = relative + approach * n;
  const double speed = __builtin_sqrt(dot(slide, slide)), most = friction * approach;
  Quad impulse = reduced * approach * n;
  if (speed > 0) impulse -= reduced * (speed < most ? speed : most) / speed * slide;
  first += impulse / m1;
  second -= impulse / m2;
}

template <class S>
void run_sum(const BlockSum& block) {
  Quad first[block_nodes];
  add_tiles<S>(block.tile, first);
  for (int n = 0; n < block_nodes; ++n) first[n] = velocity_of(first[n]);
  if (block.second_nodes) {
    Quad second[block_nodes];
    add_tiles<S>(block.second_tile, second);
    for (int n = 0; n < block_nodes; ++n) {
      const bool behind = has_mass(second[n]), before = has_mass(first[n]);
      second[n] = velocity_of(second[n]);
      if (behind && before) make_contact(load_quad(block.planes[n].value), block.friction, first[n], second[n]);
      // A field without material moves with the other one, should a point come to it.
      else if (behind)
        first[n] = second[n] * Quad{1, 1, 1, 0};
      else
        second[n] = first[n] * Quad{1, 1, 1, 0};
      store_quad(block.second_nodes[n].value, second[n]);
    }
  }
  for (int n = 0; n < block_nodes; ++n) store_quad(block.nodes[n].value, first[n]);
}

}  // namespace
}  // namespace sunder::mpm
