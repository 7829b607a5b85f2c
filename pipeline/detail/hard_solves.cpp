#include <cmath>
#include <limits>

#include "geometry/mass_properties.h"
#include "geometry/primitives.h"
#include "pipeline/detail/hard_cases.h"

namespace sunder::pipeline::detail {
namespace {

using validation::absolute;
using validation::Outcome;
using validation::within;

constexpr double infinity = std::numeric_limits<double>::infinity();

FractureInput plate_hit(double speed = 10) {
  return steel_ball_on(geometry::box(Vec3(0.2, 0.01, 0.2)), hard_glass(), speed);
}

void solve_silently(const FractureInput& input) {
  SilentProgress progress;
  fracture(input, progress);
}

/// S1
Outcome time_steps() {
  Outcome outcome;
  for (const double cfl : {0.5, 0.9}) {
    FractureInput input = plate_hit();
    input.solve.cfl = cfl;
    sound_fracture(input, "step of " + std::to_string(cfl).substr(0, 3) + " h / c", outcome);
  }
  FractureInput beyond = plate_hit();
  beyond.solve.cfl = 1.1;
  outcome.checks.push_back(refused("step of 1.1 h / c", ErrorKind::usage, "cfl", [&] { solve_silently(beyond); }));
  return outcome;
}

/// S2. The band of a coarse grid is wider than 2 E G_f / sigma_f^2: the front model keeps the energy at a lower
/// strength of propagation and says so.
Outcome band_wider_than_allowed() {
  Outcome outcome;
  const FractureInput input = plate_hit();
  const FractureOutcome r = sound_fracture(input, "glass of 40 MPa on 10 mm cells", outcome);
  outcome.checks.push_back(within("l_ch over l_max", r.solve.band_width / r.solve.admissible_length, 1, infinity));
  outcome.checks.push_back(
      within("strength at the front over that of the material", r.solve.propagation_strength / 40e6, 1e-3, 1));
  return outcome;
}

/// S3, S4, S9: what a material or a load cannot be.
Outcome impossible_strengths() {
  Outcome outcome;
  Material printed = hard_glass();
  printed.tensile_strength = 200;
  sound_fracture(steel_ball_on(geometry::cup(0.1, 0.006), printed, 10), "strength of 200 Pa", outcome);
  for (const double strength : {0.0, -1.0, std::nan("")}) {
    FractureInput input = plate_hit();
    input.material.tensile_strength = strength;
    outcome.checks.push_back(refused("strength of " + std::to_string(strength) + " Pa", ErrorKind::usage,
                                     "tensile strength", [&] { solve_silently(input); }));
  }
  return outcome;
}

Outcome poisson_ratios() {
  Outcome outcome;
  for (const double nu : {0.49, 0.0, -0.2}) {
    FractureInput input = steel_ball_on(geometry::cup(0.1, 0.006), hard_glass(), 10);
    input.material.poisson_ratio = nu;
    sound_fracture(input, "Poisson's ratio " + std::to_string(nu).substr(0, nu < 0 ? 4 : 4), outcome);
  }
  for (const double nu : {0.5, -1.0}) {
    FractureInput input = plate_hit();
    input.material.poisson_ratio = nu;
    outcome.checks.push_back(
        refused("Poisson's ratio " + std::to_string(nu), ErrorKind::usage, "Poisson", [&] { solve_silently(input); }));
  }
  return outcome;
}

/// S5
Outcome crushed_and_lonely() {
  Outcome outcome;
  for (const int particles : {1, 7, 40})
    sound_fracture(steel_ball_on(geometry::sphere(0.05, 2), hard_glass(), 80, particles),
                   std::to_string(particles) + " particles", outcome);
  Material jelly = hard_glass();
  jelly.youngs_modulus = 1e6;
  jelly.density = 10;
  jelly.tensile_strength = 1e9;
  jelly.fracture_energy = 1e9;
  FractureInput input = steel_ball_on(geometry::box(Vec3::Constant(0.1)), jelly, 400);
  input.partners[0].mass = 1;
  const FractureOutcome r = sound_fracture(input, "jelly crushed at 400 m/s", outcome);
  outcome.checks.push_back(
      within("jelly: deformations out of the law's range, reset", static_cast<double>(r.solve.crushed_resets), 1, 1e9));
  return outcome;
}

/// S6, the part of the solve: every particle twice at the same place.
Outcome coincident_particles() {
  const auto plate = geometry::box(Vec3(0.2, 0.01, 0.2));
  SilentProgress progress;
  auto particles = std::make_shared<Particles>();
  particles->samples = geometry::sample_solid(plate, {.count = 800}, progress);
  auto& points = particles->samples.points;
  points.insert(points.end(), points.begin(), points.end());
  FractureInput input = plate_hit();
  input.own = particles;
  Outcome outcome;
  sound_fracture(input, "every particle twice", outcome);
  return outcome;
}

/// S8. Equal principal stresses: a block that is pulled apart in all directions alike, and along two.
Outcome equal_eigenvalues() {
  Outcome outcome;
  for (const Vec3& pull : {Vec3(1, 1, 1), Vec3(1, 1, 0)}) {
    const FractureInput base = steel_ball_on(geometry::box(Vec3::Constant(0.1)), hard_glass(), 1);
    SilentProgress progress;
    const auto samples = geometry::sample_solid(base.mesh, {.count = 1500}, progress);
    mpm::SolveInput input{samples.points, 1e-3, {2500, 70e9, 0.22, 40e6, 8, 0}, base.loads, base.partners};
    for (int axis = 0; axis < 3; ++axis)
      for (const double side : {-1.0, 1.0}) {
        if (pull[axis] == 0) continue;
        Box slab(Vec3::Constant(-1), Vec3::Constant(1));
        (side < 0 ? slab.max() : slab.min())[axis] = side * 0.045;
        std::array<bool, 3> axes = {false, false, false};
        axes[static_cast<std::size_t>(axis)] = true;
        input.held.push_back({slab, side * 5 * Vec3::Unit(axis), axes});
      }
    const mpm::SolveResult r = mpm::solve(input, {}, progress);
    double wild = 0, outside = 0;
    for (const mpm::ParticleState& p : r.particles) {
      wild += !(p.displacement.allFinite() && p.velocity.allFinite());
      outside += !(p.damage >= 0 && p.damage <= 1);
    }
    const std::string what = pull[2] != 0 ? "pulled along three axes: " : "pulled along two axes: ";
    outcome.checks.push_back(absolute(what + "values that are not finite", wild, 0, 0));
    outcome.checks.push_back(absolute(what + "damage outside of [0, 1]", outside, 0, 0));
    outcome.checks.push_back(within(what + "particles that failed", static_cast<double>(r.failures), 1, 1e9));
    outcome.particle_steps += static_cast<double>(r.steps) * static_cast<double>(r.particles.size());
  }
  return outcome;
}

/// S9
Outcome loads_that_are_none() {
  Outcome outcome;
  const auto with = [](auto change) {
    FractureInput input = plate_hit();
    change(input);
    return [input] { solve_silently(input); };
  };
  auto& checks = outcome.checks;
  checks.push_back(refused("speed 0", ErrorKind::usage, "approach_speed",
                           with([](FractureInput& i) { i.loads[0].approach_speed = 0; })));
  checks.push_back(refused("speed that is not a number", ErrorKind::usage, "approach_speed",
                           with([](FractureInput& i) { i.loads[0].approach_speed = std::nan(""); })));
  checks.push_back(refused("contact of two planes", ErrorKind::usage, "effective_radius",
                           with([](FractureInput& i) { i.loads[0].pair.effective_radius = infinity; })));
  checks.push_back(refused("contact without stiffness", ErrorKind::usage, "effective_modulus",
                           with([](FractureInput& i) { i.loads[0].pair.effective_modulus = 0; })));
  checks.push_back(refused("partner without mass", ErrorKind::usage, "mass",
                           with([](FractureInput& i) { i.partners[0].mass = 0; })));
  checks.push_back(
      refused("no load at all", ErrorKind::usage, "load", with([](FractureInput& i) { i.loads.clear(); })));
  FractureInput touch = plate_hit(1e-3);
  const FractureOutcome r = sound_fracture(touch, "a touch of 1 mm/s", outcome);
  checks.push_back(absolute("a touch: particles that failed", static_cast<double>(r.solve.failures), 0, 0));
  return outcome;
}

/// X1
Outcome thin_glass() {
  Outcome outcome;
  sound_fracture(steel_ball_on(geometry::box(Vec3(0.3, 0.001, 0.3)), hard_glass(), 10, 20000), "plate of 1 mm, 70 GPa",
                 outcome);
  sound_fracture(steel_ball_on(geometry::box(Vec3(0.3, 0.0006, 0.3)), hard_glass(), 10), "foil under a spacing thick",
                 outcome);
  return outcome;
}

/// X3
Outcome speeds() {
  Outcome outcome;
  for (const double speed : {5.0, 50.0, 500.0, 2000.0, 5000.0})
    sound_fracture(plate_hit(speed), std::to_string(static_cast<int>(speed)) + " m/s", outcome);
  return outcome;
}

/// X4. Speeds that bring the same energy per crack area: v^2 size is constant.
Outcome sizes() {
  Outcome outcome;
  for (const double size : {1e-5, 1e-3, 0.02, 20.0, 100.0}) {
    char name[32];
    std::snprintf(name, sizeof name, "%g m", size);
    sound_fracture(steel_ball_on(geometry::box(size * Vec3(1, 0.06, 1)), hard_glass(), 10 * std::sqrt(0.2 / size)),
                   name, outcome);
  }
  return outcome;
}

/// X11
Outcome materials() {
  Outcome outcome;
  const auto cup = geometry::cup(0.1, 0.006);
  Material tough = hard_glass(), soft = hard_glass(), heavy = hard_glass(), steady = hard_glass();
  tough.fracture_energy = 1e5;
  soft.youngs_modulus = 1e6;
  heavy.density = 2e5;
  steady.weibull_modulus = 0.5;
  sound_fracture(steel_ball_on(cup, tough, 10), "fracture energy 100 kJ/m^2", outcome);
  sound_fracture(steel_ball_on(cup, soft, 10), "glass as soft as rubber", outcome);
  sound_fracture(steel_ball_on(cup, heavy, 10), "density 200 t/m^3", outcome);
  sound_fracture(steel_ball_on(cup, steady, 10), "Weibull modulus 0.5", outcome);
  return outcome;
}

}  // namespace

std::vector<validation::Problem> hard_solves() {
  const std::string sound = "finite, closed, conserving", or_refused = "sound, or refused by name";
  return {{"S1", "Time step of 0.5, 0.9 and 1.1 of the limit", or_refused, time_steps},
          {"S2", "Damage band wider than the material allows", sound, band_wider_than_allowed},
          {"S3", "Strength of 200 Pa, zero, negative, none", or_refused, impossible_strengths},
          {"S4", "Poisson's ratio up to and at its limits", or_refused, poisson_ratios},
          {"S5", "Crushed material, lonely particles", sound, crushed_and_lonely},
          {"S6", "Coincident particles", sound, coincident_particles},
          {"S8", "Equal principal stresses", sound, equal_eigenvalues},
          {"S9", "Loads that are none", or_refused, loads_that_are_none},
          {"X1", "Glass at real stiffness, 1 mm and thinner", sound, thin_glass},
          {"X3", "Speeds up to 5000 m/s", sound, speeds},
          {"X4", "Bodies from 10 um to 100 m", sound, sizes},
          {"X11", "Materials at the edge", sound, materials}};
}

}  // namespace sunder::pipeline::detail
