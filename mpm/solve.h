#pragma once
/// One short explicit damage solve of one body under its loads: what a load does to the material of one body.
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/progress.h"
#include "core/stopwatch.h"
#include "core/types.h"
#include "mpm/continuum.h"
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
  double energy_factor = 0.8;  ///< k: G_f is scaled by it at the front, where the numerical tip is blunt
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
  std::optional<double> scatter_length;  ///< correlation length of the strength [m]; not set: 3 h
  double quiet_transits = 2;             ///< stop when no particle failed for this long after the contact, in L / c_p
  double most_transits = 8;              ///< stop this long after the contact at the latest
  double most_damaged_share = 1;         ///< stop when this share of the particles is damaged
  long most_steps = 10000000;            ///< stop after so many steps whatever happens
  Spline spline = Spline::quadratic;
  bool two_fields = false;      ///< material on the two sides of a crack front's path moves apart (front rules only)
  double crack_friction = 0.3;  ///< Coulomb's coefficient between them
  bool energy_ledger = true;    ///< book where the work of the loads goes
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

/// Damage that particles keep from one solve to the next.
struct PriorDamage {
  std::vector<double> damage;  ///< by particle; empty: none
  struct Front {
    int particle;
    Vec3 normal;  ///< of the crack there, unit
  };
  std::vector<Front> fronts;  ///< particles on the mid-surfaces of cracks
};

/// What ended a solve.
enum class StopReason {
  quiet,       ///< contacts over and nothing failed for a while
  time_limit,  ///< contacts over, but things still fail: the longest time allowed
  damage,      ///< the damaged share asked for
  steps,       ///< the number of steps allowed
};
const char* name_of(StopReason reason);

/// Where the work went [J]. What is missing in the sum is the dissipation of the transfers and of the time steps.
struct EnergyLedger {
  double work = 0;                      ///< of loads and held regions on the body
  double kinetic = 0;                   ///< at the end
  double tension = 0, compression = 0;  ///< elastic at the end, by the sign of the principal stresses
  double fracture = 0;                  ///< dissipated by damage
  double viscous = 0;                   ///< dissipated by viscosity
  double balance() const { return work - (kinetic + tension + compression + fracture + viscous); }
};

struct SolveResult {
  std::vector<ParticleState> particles;  ///< in the order of the points given
  std::vector<LoadResult> loads;
  StopReason stop = StopReason::quiet;
  double cell_size = 0;                ///< h [m]
  double time_step = 0, duration = 0;  ///< [s]
  long steps = 0;
  double particle_mass = 0;  ///< [kg]
  double work = 0;           ///< of the loads on the body less its rigid translation, largest value reached [J]
  double impact_energy = 0;  ///< kinetic, of body and partners in their common frame: 1/2 m_s v^2 for one partner [J]
  std::optional<EnergyLedger> energy;  ///< not set: settings.energy_ledger is off
  double damaged_share = 0;            ///< particles with damage >= 0.95 / particles
  long failures = 0;                   ///< particles that failed in this solve
  PriorDamage cracks;                  ///< for a later solve of the same particles
  long nuclei = 0;                     ///< cracks that started in virgin material (front rules)
  long crushed_resets = 0;  ///< particles whose deformation left the range of the material law and was reset, counted
  std::size_t memory = 0;   ///< of particles and grid [bytes]

  Effort two_field_steps;    ///< steps that were made with two fields; none before a crack opened
  Effort scattered_points;   ///< whose strength was scattered
  Effort evaluated_ledgers;  ///< of energy, at the end; what steps add up is in their own time

  // What the resolution does to the material (band l_ch against l_max = 2 E G_f / sigma_f^2).
  double band_width = 0, admissible_length = 0;  ///< [m]
  double propagation_strength = 0;               ///< strength used at crack fronts (front) or everywhere (local) [Pa]
};

/// One body and what acts on it.
struct SolveInput {
  std::vector<Vec3> points;  ///< material positions [m]
  double volume = 0;         ///< of the body, shared equally by the points [m^3]
  Material material;
  std::vector<Load> loads;
  std::vector<Partner> partners;
  std::vector<HeldRegion> held = {};  ///< fixed parts of the body
  PriorDamage prior = {};             ///< what earlier solves did to these particles
};

/// How long a solve will be, known before its points are.
struct Forecast {
  double cell_size = 0, time_step = 0;  ///< h [m], [s]
  long least_steps = 0;                 ///< when nothing fails
  long most_steps = 0;                  ///< when things fail to the end
};

/// Of `input` with `count` points in `box`; its own points are not looked at. The time that lies between the bounds is
/// not known before the solve.
Forecast forecast(const SolveInput& input, const Box& box, long count, const SolveSettings& settings);

/// The result does not depend on the number of threads. Errors: ErrorKind::unstable when a value stops being finite
/// (names the particle and its state), ErrorKind::interrupted from `progress`, ErrorKind::usage for an impossible
/// material or load, or a time step beyond the limit of stability.
SolveResult solve(const SolveInput& input, const SolveSettings& settings, Progress& progress);

}  // namespace sunder::mpm
