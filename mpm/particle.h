#pragma once
/// The state of a material point.
#include "core/types.h"

namespace sunder::mpm {

/// Where a particle stands with respect to cracks (front rules).
enum class CrackRole : unsigned char {
  virgin,  ///< sound
  front,   ///< part of a crack's mid-surface: pulls the crack ahead and shields beside it
  filler,  ///< fills the band of a crack to its numerical width
};

struct Particle {
  int id = 0;                                 ///< index in the points of the caller
  Vec3 material_position = Vec3::Zero();      ///< X [m]
  Vec3 displacement = Vec3::Zero();           ///< u = x - X, kept apart so that small motions keep their digits [m]
  Vec3 velocity = Vec3::Zero();               ///< [m/s]
  Mat3 affine_velocity = Mat3::Zero();        ///< C [1/s]; starts at zero, not at the identity that Fan 2.2.3 prints
  Mat3 displacement_gradient = Mat3::Zero();  ///< H = F - I
  Mat3 affine_momentum = Mat3::Zero();        ///< m C - dt V0 (4/h^2) tau: what particle_to_grid spreads [kg/s]
  double nucleation_strength = 0;             ///< of virgin material, with scatter [Pa]
  double threshold = 0;        ///< r, the largest effective stress reached, at least the strength in force [Pa]
  double strength = 0;         ///< in force after the start of a crack [Pa]
  double softening_slope = 0;  ///< H of the softening law in force
  double damage = 0;           ///< c
  double damage_time = -1;     ///< when c reached 1 [s]
  double dissipated = 0;       ///< per volume [J/m^3]
  CrackRole role = CrackRole::virgin;
  bool escaped = false;  ///< flew so far that the grid no longer follows it

  Vec3 position() const { return material_position + displacement; }
};

}  // namespace sunder::mpm
