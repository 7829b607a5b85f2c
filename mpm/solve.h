#pragma once
/// One short explicit damage solve of one body under its loads: what a load does to the material of one body.
#include <cstdint>
#include <string>
#include <vector>

#include "core/progress.h"
#include "core/types.h"
#include "mpm/hertz_contact.h"
#include "mpm/material.h"

namespace sunder::mpm {

/// An impact as the solver sees it. The body starts at rest in its own frame; the partner arrives along -outward.
struct Load {
  Vec3 point = Vec3::Zero();     ///< on the body's surface, material coordinates [m]
  Vec3 outward = Vec3::UnitY();  ///< unit normal out of the body; the partner pushes along -outward
  double approach_speed = 0;     ///< of the partner towards the body along -outward, > 0 [m/s]
  ContactPair pair;
  int partner = 0;  ///< loads with the same partner share its mass and motion
};

/// Who pushes. Its velocity change is common to all of its loads.
struct Partner {
  double mass = std::numeric_limits<double>::infinity();  ///< [kg]; infinite: ground, wall, held body
};

enum class DamageModel {
  front,  ///< crack-front rules: see mpm/front.h
  local,  ///< every particle decides alone at one strength (Fan 2024)
};

enum class LoadModel {
  contact,     ///< Hertz contact integrated inside the solve: exact impulse and energy balance
  prescribed,  ///< F(t) = F_max sin^1.5(pi t / t_c) with the impulse of a rigid impact (Fan 3.8-3.11 with the Hertz
               ///< time course)
};

/// Crack-front rules: distances in cell sizes h, angles in degrees.
struct FrontSettings {
  double shield_radius = 3;    ///< R_s: beside a crack and nearer than this no parallel crack starts
  double filler_width = 1.0;   ///< w_b: beside a crack and nearer than this the band fills to its numerical width
  double ahead_angle = 35;     ///< half angle about the crack plane that counts as ahead of the front
  double parallel_angle = 50;  ///< cracks whose normals differ by more do not see each other
  double ahead_reach = 1.5;    ///< how far ahead a front can pull
  double speed = 0.4;          ///< of the front, in P-wave speeds
  double energy_factor = 0.4;  ///< k: G_f is scaled by it at the front, where the numerical tip is blunt
};

struct SolveSettings {
  DamageModel damage = DamageModel::front;
  LoadModel load = LoadModel::contact;
  FrontSettings front;
  double cells_per_spacing = 0.5;  ///< particle spacings are h * this: 8 particles a cell
  double cfl = 0.35;               ///< dt = cfl h / c_p
  double viscosity = 0.1;          ///< of undamaged material, in rho c_p h
  double band_width = 2.2;         ///< l_ch in h: width of the numerical damage band (Fan prints sqrt(3), 40 % off)
  double smallest_patch = 1.5;     ///< radius of the loaded patch is at least this many h
  double scatter_length = 3;       ///< correlation length of the strength in h
  double quiet_transits = 2;       ///< stop when no particle failed for this long after the contact, in L / c_p
  double most_transits = 8;        ///< stop this long after the contact at the latest
  std::uint64_t seed = 1;
};

/// How one load ended.
struct LoadResult {
  double impulse = 0;                      ///< delivered to the body along -outward [N s]
  double peak_force = 0;                   ///< [N]
  double first_time = -1, last_time = -1;  ///< of contact [s]; -1: never touched
};

struct ParticleState {
  Vec3 displacement = Vec3::Zero();   ///< [m]
  Vec3 velocity = Vec3::Zero();       ///< [m/s], in the frame in which the body was at rest
  Vec3 spin_momentum = Vec3::Zero();  ///< angular momentum of the affine velocity about the particle [kg m^2/s]
  double damage = 0;
  double damage_time = -1;  ///< when damage reached 1 [s]; -1: never
};

struct SolveResult {
  std::vector<ParticleState> particles;  ///< in the order of the points given
  std::vector<LoadResult> loads;
  double cell_size = 0;                ///< h [m]
  double time_step = 0, duration = 0;  ///< [s]
  long steps = 0;
  double particle_mass = 0;  ///< [kg]
  double work = 0;           ///< of the loads on the body less its rigid translation, largest value reached [J]
  double impact_energy = 0;  ///< kinetic, of body and partners in their common frame: 1/2 m_s v^2 for one partner [J]
  double dissipated = 0;     ///< by damage [J]
  double damaged_share = 0;  ///< particles with damage >= 0.95 / particles
  long nuclei = 0;           ///< cracks that started in virgin material (front rules)
  long crushed_resets = 0;   ///< particles whose deformation left the range of the material law and was reset, counted

  // What the resolution does to the material (band l_ch against l_max = 2 E G_f / sigma_f^2).
  double band_width = 0, admissible_length = 0;  ///< [m]
  double propagation_strength = 0;               ///< strength used at crack fronts (front) or everywhere (local) [Pa]
};

/// Explicit MLS-MPM (Hu et al. 2018) with quadratic B-splines and APIC, neo-Hookean elasticity in H = F - I, Rankine
/// damage. `points`: material positions, each of volume `volume` / points.size() [m^3]. The result does not depend on
/// the number of threads. Errors: ErrorKind::unstable when a value stops being finite (names step and particle),
/// ErrorKind::interrupted from `progress`, ErrorKind::usage for an impossible material or load.
SolveResult solve(const std::vector<Vec3>& points, double volume, const Material& material,
                  const std::vector<Load>& loads, const std::vector<Partner>& partners, const SolveSettings& settings,
                  Progress& progress);

}  // namespace sunder::mpm
