#pragma once
/// The state of material points, in structures of arrays of eight. No Eigen here: this is read by code that is compiled
/// once per instruction set, and inline functions shared between those would be linked from any of them.

namespace sunder::mpm {

constexpr int chunk_size = 8;

/// Eight points. Matrices are row by row.
struct alignas(64) PointChunk {
  double material_position[3][chunk_size];      ///< X [m]
  double displacement[3][chunk_size];           ///< u = x - X, kept apart so that small motions keep their digits [m]
  double displacement_gradient[9][chunk_size];  ///< H = F - I
  double threshold[chunk_size];        ///< r, the largest effective stress reached, at least the strength in force [Pa]
  double damage[chunk_size];           ///< c
  double strength[chunk_size];         ///< in force; infinity: no crack has started here [Pa]
  double softening_slope[chunk_size];  ///< H of the softening law in force
  double damage_time[chunk_size];      ///< when c reached failed_damage [s]; -1: never
  double dissipated[chunk_size];       ///< by damage, per volume [J/m^3]
  unsigned long long side[chunk_size];  ///< bit n: behind the crack plane of node n of the stencil, x slowest
  int side_corner[chunk_size];          ///< lowest node of the stencil, in its block, that `side` belongs to
  int id[chunk_size];                   ///< index in the points of the caller; -1: nobody
};

/// What the points of a chunk do, where it is given or asked for: during a step neither is ever stored.
struct alignas(64) MotionChunk {
  double velocity[3][chunk_size];         ///< [m/s]
  double affine_velocity[9][chunk_size];  ///< C [1/s]; starts at zero, not at the identity that Fan 2.2.3 prints
};

/// Damage from which a point counts as failed.
constexpr double failed_damage = 0.99;

}  // namespace sunder::mpm
