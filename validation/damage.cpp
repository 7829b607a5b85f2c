#include <cmath>

#include <Eigen/Geometry>

#include "mpm/rankine.h"
#include "validation/catalogue.h"
#include "validation/specimen.h"

namespace sunder::validation {
namespace {

using mpm::admissible_length;
using mpm::CoarseGrid;
using mpm::make_softening;
using mpm::Softening;

constexpr double modulus = 32e9, density = 2450, strength = 3.08e6, fracture_energy = 3;

/// What a material point has been through.
struct Point {
  Softening law;
  double r = 0, damage = 0, dissipated = 0;

  /// Effective stress -> stress, with history: Fan (2024) 2.28 without its running maximum dissipates nothing.
  Mat3 load(const Mat3& effective) {
    const mpm::PrincipalStress s = mpm::principal_stress(effective);
    const double before = std::max(r, law.strength);
    if (s.value[2] > before) {
      r = s.value[2];
      const double now = std::max(damage, law.damage(r));
      dissipated += (now - damage) * 0.25 * (before * before + r * r) / modulus;
      damage = now;
    }
    return mpm::damaged_stress(s, damage);
  }

  double stress(double strain) { return load(Vec3(modulus * strain, 0, 0).asDiagonal())(0, 0); }
  void ramp(double from, double to) {
    constexpr int steps = 1000;
    for (int n = 1; n <= steps; ++n) stress(from + (to - from) * n / steps);
  }
};

Point point_of_band(double band) {
  return {make_softening(modulus, strength, fracture_energy, band, CoarseGrid::lower_strength)};
}

/// B1: a bar of 10 mm with nu = 0, one row of two points a cell, pulled at both ends at a steady rate.
struct Bar {
  double peak = 0, remaining = 0;  ///< stress over the strength
  double dissipated = 0;           ///< over the fracture energy
};

/// The middle cell is 2 % weaker. The grips hold whole nodes and so concentrate the strain beside them: nothing breaks
/// there.
void give_laws(double length, double band_in_h, mpm::Continuum& body) {
  const double h = body.cell_size();
  for (int id = 0; id < body.size(); ++id) {
    mpm::PointState p = body.point(id);
    const double x = p.material_position[0];
    if (std::min(x, length - x) < 2 * h) continue;
    const double factor = std::abs(x - length / 2) < 0.6 * h ? 0.98 : 1;
    const Softening law =
        make_softening(modulus, factor * strength, fracture_energy, band_in_h * h, CoarseGrid::lower_strength);
    p.strength = p.threshold = law.strength;
    p.softening_slope = law.slope;
    body.set_point(id, p);
  }
}

/// Mean stress of a strain gauge between the grip and the crack.
double gauge(const mpm::Continuum& body) {
  double strain = 0;
  const int first = body.size() / 8, last = body.size() * 3 / 8;
  for (int id = first; id < last; ++id) strain += body.displacement_gradient(id)(0, 0) / (last - first);
  return modulus * strain;
}

Bar pull_bar(int cells, double band_in_h, double rate, Outcome& outcome) {
  constexpr double length = 0.01;
  const double h = length / cells;
  Lattice lattice;
  lattice.cell_size = h;
  lattice.particle_volume = h * h * h / 2;
  for (int n = 0; n < 2 * cells; ++n) lattice.points.emplace_back((n + 0.5) * h / 2, 0, 0);
  const mpm::Material material{density, modulus, 0, strength, fracture_energy, 0};
  SpecimenSettings settings;
  settings.solve.cfl = 0.2;
  settings.anchor = Vec3::Zero();
  const Vec3 far = Vec3::Constant(1), pull(0.5 * rate * length, 0, 0);
  settings.held = {{Box(-far, Vec3(0.5001 * h, 1, 1)), -pull, {true, false, false}},
                   {Box(Vec3(length - 0.5001 * h, -1, -1), far), pull, {true, false, false}}};
  settings.motion = [&](const Vec3& x) {
    mpm::Motion m;
    m.velocity[0] = rate * (x[0] - length / 2);
    m.affine_velocity(0, 0) = rate;
    return m;
  };
  Specimen bar(lattice, material, settings);
  give_laws(length, band_in_h, bar.body);
  // The crack is open at 2 G_f / sigma_f; half as much again for the spread of the band, after the elastic stretch.
  const double opening = 2 * fracture_energy / strength;
  const double end = (1.5 * opening + strength / modulus * length) / (rate * length);
  Bar result;
  while (bar.time() < end) {
    bar.step();
    result.remaining = gauge(bar.body) / strength;
    result.peak = std::max(result.peak, result.remaining);
  }
  result.dissipated = bar.dissipated() / (fracture_energy * h * h);
  outcome.particle_steps += bar.particle_steps();
  return result;
}

/// B1. The energy per area of crack is the fracture energy on every mesh when the law is given the width of the
/// numerical band, 2.2 h. Fan prints sqrt(3) h, which dissipates 20-40 % too much.
Outcome bar_in_tension() {
  Outcome outcome;
  double least = 1e9, most = 0;
  for (int cells : {20, 40, 80}) {
    const Bar bar = pull_bar(cells, 2.2, 2, outcome);
    const std::string name = std::to_string(cells) + " cells: ";
    outcome.checks.push_back(relative(name + "peak stress [sigma_f]", bar.peak, 1, 0.01));
    outcome.checks.push_back(relative(name + "dissipated energy per area [G_f]", bar.dissipated, 1, 0.1));
    outcome.checks.push_back(absolute(name + "stress left [sigma_f]", bar.remaining, 0, 0.1));
    least = std::min(least, bar.dissipated);
    most = std::max(most, bar.dissipated);
  }
  outcome.checks.push_back(relative("spread of the energy over the meshes [1]", most / least, 1, 0.05));
  const Bar printed = pull_bar(40, std::sqrt(3.0), 2, outcome);
  outcome.checks.push_back(
      within("energy with the printed band sqrt(3) h, for the record [G_f]", printed.dissipated, 1.12, 1.5));
  return outcome;
}

StudyPoint bar_energy_error(int cells) {
  Outcome outcome;
  const Bar bar = pull_bar(cells, 2.2, 2, outcome);
  return {std::abs(bar.dissipated - 1), outcome.particle_steps};
}

/// Beyond l_max: either the strength or the energy gives way, by how much is known, and damage stays in [0, 1].
void too_coarse(Outcome& outcome) {
  const double l_max = admissible_length(70e9, 40e6, 8);
  double strength_error = 0, energy_error = 0, kept_error = 0, outside = 0;
  for (double share : {1.0, 2.0, 25.0}) {
    const double band = share * l_max;
    const Softening lowered = make_softening(70e9, 40e6, 8, band, CoarseGrid::lower_strength);
    const double s = lowered.strength, energy = (1 + 1 / lowered.slope) * s * s / (2 * 70e9) * band;
    strength_error = std::max(strength_error, std::abs(s / std::sqrt(2 * 70e9 * 8 / (1.1 * band)) - 1));
    energy_error = std::max(energy_error, std::abs(energy / 8 - 1));
    const Softening kept = make_softening(70e9, 40e6, 8, band, CoarseGrid::keep_strength);
    kept_error = std::max(kept_error, std::abs(kept.fracture_energy / (band * 40e6 * 40e6 / (2 * 70e9)) - 1));
    outside += kept.damage(40.001e6) != 1 || kept.strength != 40e6 || lowered.slope <= 0;
    for (double r = 0; r < 1e9; r += 1e6) outside += lowered.damage(r) < 0 || lowered.damage(r) > 1;
  }
  outcome.checks.push_back(absolute("beyond l_max, strength lowered: its error [1]", strength_error, 0, 1e-12));
  outcome.checks.push_back(absolute("beyond l_max, strength lowered: error of the energy [1]", energy_error, 0, 1e-12));
  outcome.checks.push_back(absolute("beyond l_max, strength kept: error of the energy [1]", kept_error, 0, 1e-12));
  outcome.checks.push_back(absolute("laws whose damage leaves [0, 1], count", outside, 0, 0));
}

/// B2
Outcome admissible_lengths() {
  Outcome outcome;
  const auto table = [&](const char* what, double e, double sigma, double g, double expected, double bound) {
    outcome.checks.push_back(
        relative(std::string("l_max of ") + what + " [m]", admissible_length(e, sigma, g), expected, bound));
  };
  table("glass", 70e9, 40e6, 8, 0.7e-3, 1e-12);
  table("concrete", 30e9, 3e6, 100, 2.0 / 3, 1e-12);
  table("Fan table 3.3 as printed", 3.2e8, 200, 200, 3.2e6, 1e-12);
  table("the same with its 200 as 2 MPa", 3.2e8, 2e6, 200, 32e-3, 1e-12);
  table("the bar of B1", modulus, strength, fracture_energy, 20.2e-3, 0.003);
  const double l_max = admissible_length(70e9, 40e6, 8);
  double error = 0;
  for (double share : {0.1, 0.5, 0.9, 0.99, 0.9999}) {
    const Softening law = make_softening(70e9, 40e6, 8, share * l_max, CoarseGrid::lower_strength);
    error = std::max(error, std::abs(law.slope / (share / (1 - share)) - 1));
  }
  outcome.checks.push_back(absolute("slope below l_max: error [1]", error, 0, 1e-9));
  too_coarse(outcome);
  // With a strength of 200 Pa no strain short of 577 breaks it, so it is a misprint.
  const Softening printed = make_softening(3.2e8, 200, 200, std::sqrt(3.0) * 2e-3, CoarseGrid::lower_strength);
  outcome.checks.push_back(
      absolute("strain at failure of Fan table 3.3 [1]", 200 * (1 + 1 / printed.slope) / 3.2e8, 577, 1));
  return outcome;
}

/// B3. Load to twice the strain at the strength, unload, reload, fail, press together.
Outcome cyclic_dissipation() {
  constexpr double band = 5e-3, yield = strength / modulus;
  Point p = point_of_band(band);
  const double slope = p.law.slope;
  Outcome outcome;
  auto& checks = outcome.checks;
  p.ramp(0, 2 * yield);
  const double expected = (1 + slope) * strength * strength / (2 * modulus);
  checks.push_back(relative("dissipated at twice the strain of the strength [J/m^3]", p.dissipated, expected, 1e-3));
  const double damage = p.damage, dissipated = p.dissipated;
  const double stiffness = (p.stress(1.5 * yield) - p.stress(0.5 * yield)) / yield;
  checks.push_back(relative("stiffness while unloading [Pa]", stiffness, (1 - damage) * modulus, 1e-6));
  p.ramp(2 * yield, 0);
  p.ramp(0, 2 * yield);
  checks.push_back(absolute("damage by unloading and loading again [1]", p.damage, damage, 0));
  checks.push_back(absolute("dissipation by that [J/m^3]", p.dissipated, dissipated, 0));
  p.ramp(2 * yield, 1.2 * yield * (1 + 1 / slope));
  checks.push_back(absolute("damage at the end [1]", p.damage, 1, 0));
  checks.push_back(relative("dissipated in total [J/m^3]", p.dissipated, fracture_energy / band, 1e-3));
  checks.push_back(absolute("stress in tension then [Pa]", p.stress(yield), 0, 0));
  checks.push_back(relative("stress when pressed together then [Pa]", p.stress(-yield), -strength, 1e-9));
  return outcome;
}

/// Largest deviation of damage and stress when the input is turned.
double turning_error() {
  const Mat3 s = strength * Vec3(1.7, 0.4, -2).asDiagonal();
  Point straight = point_of_band(5e-3);
  const Mat3 answer = straight.load(s);
  double error = 0;
  for (int n = 1; n < 40; ++n) {
    const Mat3 q = Eigen::AngleAxisd(0.3 * n, Vec3(n, 7 - n, 3).normalized()).toRotationMatrix();
    Point turned = point_of_band(5e-3);
    const Mat3 back = q.transpose() * turned.load(q * s * q.transpose()) * q;
    error = std::max({error, std::abs(turned.damage - straight.damage), (back - answer).norm() / s.norm()});
  }
  return error;
}

/// B4
Outcome sign_and_invariance() {
  Point crushed = point_of_band(5e-3);
  for (double s : {1.0, 10.0, 1e4})
    for (const Vec3& v : {Vec3(-1, 0, 0), Vec3(-1, -1, -1), Vec3(-3, -2, -1)})
      crushed.load((s * strength * v).asDiagonal());
  Mat3 shear = Mat3::Zero();
  shear(0, 1) = shear(1, 0) = strength;
  Point below = point_of_band(5e-3), above = point_of_band(5e-3);
  below.load((1 - 1e-9) * shear);
  above.load((1 + 1e-9) * shear);
  // Two and three equal principal stresses.
  Point equal = point_of_band(5e-3);
  double skew = 0;
  for (const Vec3& v : {Vec3(1.5, 1.5, 1.5), Vec3(2, 2, -1)}) {
    const Mat3 stress = equal.load((strength * v).asDiagonal());
    skew = std::max(skew, (stress - stress.transpose()).norm() / strength);
  }
  Outcome outcome;
  outcome.checks = {absolute("damage by compression of up to 30000 sigma_f [1]", crushed.damage, 0, 0),
                    absolute("dissipation by it [J/m^3]", crushed.dissipated, 0, 0),
                    absolute("damage by a shear stress just below sigma_f [1]", below.damage, 0, 0),
                    within("damage by a shear stress just above sigma_f [1]", above.damage, 1e-12, 1e-6),
                    absolute("skew part of the stress, equal principal stresses [sigma_f]", skew, 0, 1e-12),
                    absolute("damage and stress against those of a turned input [1]", turning_error(), 0, 1e-12)};
  return outcome;
}

}  // namespace

std::vector<Problem> damage() {
  return {{"B1", "Bar in tension: peak and energy on three meshes", "G_f, sigma_f; Cervera and Chiumenti 2006",
           bar_in_tension,
           Study{"dissipated energy per area [G_f]", "cells along the bar", {20, 40, 80}, {}, bar_energy_error}},
          {"B2", "Admissible length of the softening law", "closed form 2 E G_f / sigma_f^2", admissible_lengths},
          {"B3", "Cyclic loading of a point: dissipation", "closed form", cyclic_dissipation},
          {"B4", "Compression, shear, turned input", "closed form", sign_and_invariance}};
}

}  // namespace sunder::validation
