#include <cmath>
#include <numbers>

#include "validation/detail/parts.h"
#include "validation/specimen.h"

namespace sunder::validation::detail {
namespace {

using std::numbers::pi;

const Vec3 far = Vec3::Constant(1e6);

/// A row of points along x: with nu = 0, or held across, all columns of nodes move alike. `beyond` cells stick out of
/// [0, length] at either end.
Lattice row(double length, int cells, int points_per_cell = 2, int beyond = 0) {
  Lattice lattice;
  const double h = length / cells;
  for (int n = -points_per_cell * beyond; n < points_per_cell * (cells + beyond); ++n)
    lattice.points.emplace_back((n + 0.5) * h / points_per_cell, 0, 0);
  lattice.cell_size = h;
  lattice.particle_volume = h * h * h / points_per_cell;
  return lattice;
}

/// Nodes at x and beyond stand still along x. A node lies on the wall.
mpm::HeldRegion wall(double x) { return {Box(-far, Vec3(x, far[1], far[2])), Vec3::Zero(), {true, false, false}}; }

/// Time at which a sum that starts at zero changes its sign for the `wanted`th time, linear in between.
class Crossings {
 public:
  explicit Crossings(int wanted) : wanted_(wanted) {}
  bool reached() const { return wanted_ == 0; }
  double time() const { return time_; }
  void see(double time, double value) {
    if (reached()) return;
    if (last_ * value < 0 && --wanted_ == 0) time_ = last_time_ + (time - last_time_) * last_ / (last_ - value);
    last_ = value;
    last_time_ = time;
  }

 private:
  int wanted_;
  double last_ = 0, last_time_ = 0, time_ = 0;
};

struct BarVibration {
  double period = 0;  ///< [4 L / c]
  double energy = 0;  ///< after one period, over that at the start
  double particle_steps = 0;
};

/// L = E = rho = 1, nu = 0, fixed at x = 0, in its first mode.
BarVibration vibrate_bar(int cells, double cfl) {
  const Lattice lattice = row(1, cells);
  const mpm::Material material{.density = 1, .youngs_modulus = 1};
  SpecimenSettings settings;
  settings.solve.cfl = cfl;
  settings.anchor = Vec3::Zero();
  settings.held = {wall(1e-6)};
  const double k = pi / 2, v = 1e-4;
  settings.motion = [&](const Vec3& x) {
    mpm::Motion m;
    m.velocity[0] = v * std::sin(k * x[0]);
    m.affine_velocity(0, 0) = v * k * std::cos(k * x[0]);
    return m;
  };
  Specimen bar(lattice, material, settings);
  std::vector<mpm::Motion> motion;
  for (const Vec3& x : lattice.points) motion.push_back(settings.motion(x));
  const double before = bar.body.energy(motion).kinetic;
  Crossings crossings(2);
  while (!crossings.reached()) {
    bar.step();
    double mode = 0;
    for (int id = 0; id < bar.body.size(); ++id)
      mode += std::sin(k * bar.body.material_position(id)[0]) * bar.body.displacement(id)[0];
    crossings.see(bar.time(), mode);
  }
  const auto after = bar.body.energy(bar.body.finish());
  return {crossings.time() / 4, (after.kinetic + after.elastic()) / before, bar.particle_steps()};
}

/// A5. The wall and the free end are smeared over half a cell each: first order.
Outcome bar_vibration() {
  const BarVibration coarse = vibrate_bar(32, 0.2), fine = vibrate_bar(64, 0.2);
  const double order = std::log2((coarse.period - 1) / (fine.period - 1));
  Outcome outcome;
  outcome.checks = {relative("period, 32 cells [4L/c]", coarse.period, 1, 0.01),
                    relative("period, 64 cells [4L/c]", fine.period, 1, 0.004),
                    within("order of the error in h [1]", order, 0.8, 2.2)};
  outcome.particle_steps = coarse.particle_steps + fine.particle_steps;
  return outcome;
}

StudyPoint period_error(int cells) {
  const BarVibration r = vibrate_bar(cells, 0.2);
  return {std::abs(r.period - 1), r.particle_steps};
}

/// A6
Outcome energy_drift() {
  Outcome outcome;
  const auto run = [&](int cells, double cfl) {
    const BarVibration r = vibrate_bar(cells, cfl);
    outcome.particle_steps += r.particle_steps;
    return r.energy;
  };
  const double energy = run(32, 0.2), halved = run(32, 0.1);
  outcome.checks = {relative("energy after a period, 16 cells, APIC [at the start]", run(16, 0.2), 1, 0.02),
                    relative("energy after a period, 32 cells, APIC [at the start]", energy, 1, 0.01),
                    absolute("the same with half the time step", halved, energy, 0.002)};
  return outcome;
}

/// A7. L = 10, A = 1, E = 3e7, rho = 0.73, v = 202.2: 3 % strain, of which the neo-Hookean law makes 1.6 % more stress.
Outcome rod_on_wall() {
  constexpr double length = 10, speed = 202.2, modulus = 3e7, density = 0.73;
  constexpr int cells = 64;
  const Lattice lattice = row(length, cells);
  const mpm::Material material{.density = density, .youngs_modulus = modulus};
  const double h = length / cells, area = h * h, c = material.p_wave_speed(), expected = 2 * length / c;
  SpecimenSettings settings;
  settings.solve.cfl = 0.2;
  settings.anchor = Vec3::Zero();
  settings.held = {wall(1e-6 * h)};
  settings.motion = [&](const Vec3&) { return mpm::Motion{Vec3(-speed, 0, 0), Mat3::Zero()}; };
  Specimen rod(lattice, material, settings);
  double plateau = 0, left = -1;
  long samples = 0;
  for (int n = 0; n < 8; ++n) rod.step();
  rod.force(0);
  // A held region is sticky: it lets go at the first tension, averaged over the time that a wave needs for a cell.
  while (left < 0 && rod.time() < 2 * expected) {
    for (int n = 0; n < 5; ++n) rod.step();
    const double force = rod.force(0)[0] / area;
    if (rod.time() > 0.1 * expected && rod.time() < 0.9 * expected) plateau += force, ++samples;
    if (force < 0) left = rod.time();
  }
  rod.hold({});
  for (int n = 0; n < 20; ++n) rod.step();
  const auto motion = rod.body.finish();
  const double mass = rod.body.particle_mass() * rod.body.size();
  Outcome outcome;
  outcome.checks = {
      relative("mean force on the plateau [N]", plateau / static_cast<double>(samples),
               speed * std::sqrt(modulus * density), 0.02),
      relative("contact lasts [2L/c]", left / expected, 1, 0.03),
      relative("speed of the centre of mass after it [v]", rod.body.momentum(motion)[0] / mass / speed, 1, 0.03)};
  outcome.particle_steps = rod.particle_steps();
  return outcome;
}

/// L = E = rho = 1, nu = 0, so that plane strain is plane stress; clamped at x = 0 and loaded by a small force along y
/// at the other end. What swings about the static shape has the first bending mode's period.
struct Swing {
  double period = 0, deflection = 0;  ///< over those of a Timoshenko beam
  double particle_steps = 0;
};

Swing swing_beam(int cells_in_depth) {
  constexpr double length = 1, depth = 0.1;
  const double h = depth / cells_in_depth;
  const Lattice lattice = plane(Box(Vec3::Zero(), Vec3(length, depth, 0)), h);
  const double area = h * depth, inertia = area * depth * depth / 12;
  const mpm::Material material{.density = 1, .youngs_modulus = 1};
  SpecimenSettings settings;
  settings.anchor = Vec3::Zero();
  settings.plane_strain = true;
  settings.held = {{Box(-far, Vec3(1e-6, far[1], far[2])), Vec3::Zero(), {true, true, true}}};
  Specimen beam(lattice, material, settings);
  std::vector<int> loaded;
  for (int id = 0; id < beam.body.size(); ++id)
    if (beam.body.material_position(id)[0] > length - 0.5 * h) loaded.push_back(id);
  // The last layer of points is a quarter of a cell inside.
  const double arm = length - 0.25 * h, force = 1e-5 * area, shear_modulus = 0.5, shear_factor = 5.0 / 6;
  const double bending = inertia / std::pow(length, 3);
  const double deflection =
      force * std::pow(arm, 3) / (3 * inertia) + force * arm / (shear_factor * shear_modulus * area);
  const double period = 2 * pi / (1.8751 * 1.8751 * std::sqrt(bending * length * 1 / (area * length)));
  double sum = 0, mean = 0, last = 0, last_time = 0;
  Swing result;
  // Released from rest, the tip is back when its velocity turns upwards: a period later.
  while (result.period == 0) {
    beam.step([&](Specimen& s) {
      for (int id : loaded) s.body.push(id, Vec3(0, force * s.time_step() / static_cast<double>(loaded.size()), 0));
    });
    double tip = 0;
    for (int id : loaded) tip += beam.body.displacement(id)[1] / static_cast<double>(loaded.size());
    sum += tip * beam.time_step();
    if (beam.time() > 0.9 * period && tip > last) result.period = last_time;
    mean = sum / beam.time();
    last = tip;
    last_time = beam.time();
  }
  result.period /= period;
  result.deflection = mean / deflection;
  result.particle_steps = beam.particle_steps();
  return result;
}

/// A9. With nu = 0 the beam in three dimensions gives the same digits.
Outcome cantilever() {
  const Swing coarse = swing_beam(3), fine = swing_beam(6);
  const auto order = [](double a, double b) { return std::log2((a - 1) / (b - 1)); };
  Outcome outcome;
  outcome.checks = {relative("period, 6 cells in depth [Euler]", fine.period, 1, 0.05),
                    relative("deflection of the tip, 6 cells [Timoshenko]", fine.deflection, 1, 0.06),
                    within("order of the error of the period in h [1]", order(coarse.period, fine.period), 0.8, 2.2),
                    within("order of that of the deflection [1]", order(coarse.deflection, fine.deflection), 0.8, 2.2)};
  outcome.particle_steps = coarse.particle_steps + fine.particle_steps;
  return outcome;
}

StudyPoint beam_period_error(int cells_in_depth) {
  const Swing r = swing_beam(cells_in_depth);
  return {std::abs(r.period - 1), r.particle_steps};
}

/// u = A sin(2 pi X) sin(pi c t), held across: E = rho = c = 1. Its body force follows from the neo-Hookean law.
class Manufactured {
 public:
  explicit Manufactured(const mpm::Material& m) : mu_(m.shear_modulus()), lambda_(m.lame_lambda()) {}
  static constexpr double amplitude = 0.01;

  double displacement(double x, double t) const { return amplitude * std::sin(k * x) * std::sin(w * t); }
  mpm::Motion start(double x) const {
    mpm::Motion m;
    m.velocity[0] = amplitude * w * std::sin(k * x);
    m.affine_velocity(0, 0) = amplitude * w * k * std::cos(k * x);
    return m;
  }
  /// u_tt - dP/dX with P = mu (F - 1/F) + lambda ln F / F.
  double body_force(double x, double t) const {
    const double f = 1 + amplitude * k * std::cos(k * x) * std::sin(w * t);
    const double f_x = -k * k * displacement(x, t);
    const double slope = mu_ * (1 + 1 / (f * f)) + lambda_ * (1 - std::log(f)) / (f * f);
    return -w * w * displacement(x, t) - slope * f_x;
  }
  /// Mean velocity over a step of what is at `place` when it begins.
  double velocity_at(double place, double t, double step) const {
    double x = place;
    for (int n = 0; n < 20; ++n) x = place - displacement(x, t);
    return (displacement(x, t + step) - displacement(x, t)) / step;
  }

 private:
  static constexpr double k = 2 * pi, w = pi;
  const double mu_, lambda_;
};

/// Largest L2 error of the displacement within half a period [A]. The material goes on for two cells beyond either end
/// and there the nodes move as the solution says, so that no surface smears the order.
double manufactured_error(int cells, int points_per_cell, Outcome& outcome) {
  const Lattice lattice = row(1, cells, points_per_cell, 2);
  const mpm::Material material{.density = 1, .youngs_modulus = 1, .poisson_ratio = 0.3};
  const Manufactured exact(material);
  const double h = lattice.cell_size;
  SpecimenSettings settings;
  settings.solve.cfl = 0.2;
  settings.anchor = Vec3::Zero();
  const double dt = settings.solve.cfl * h / material.p_wave_speed();
  const auto grips = [&](double t) {
    std::vector<mpm::HeldRegion> held = {{Box(-far, far), Vec3::Zero(), {false, true, true}}};
    for (int n = 0; n < 4; ++n)
      for (double place : {-n * h, 1 + n * h})
        held.push_back({Box(Vec3(place - 0.1 * h, -far[1], -far[2]), Vec3(place + 0.1 * h, far[1], far[2])),
                        Vec3(exact.velocity_at(place, t, dt), 0, 0),
                        {true, false, false}});
    return held;
  };
  settings.held = grips(0);
  settings.motion = [&](const Vec3& x) { return exact.start(x[0]); };
  Specimen bar(lattice, material, settings);
  double largest = 0;
  while (bar.time() < 1) {
    double squares = 0;
    bar.step([&](Specimen& s) {
      s.hold(grips(s.time()));
      for (int id = 0; id < s.body.size(); ++id) {
        const double x = s.body.material_position(id)[0];
        s.body.push(id, Vec3(s.body.particle_mass() * exact.body_force(x, s.time()) * dt, 0, 0));
        if (x < 0 || x > 1) continue;
        squares += std::pow(s.body.displacement(id)[0] - exact.displacement(x, s.time()), 2);
      }
    });
    largest = std::max(largest, std::sqrt(squares / (points_per_cell * cells)));
  }
  outcome.particle_steps += bar.particle_steps();
  return largest / Manufactured::amplitude;
}

/// A10. The solution moves points by 0.6 cells of the finest mesh and strains them by 6 %: with only two of them along
/// a cell, what is left at 64 cells is the quadrature's error (ratio 2.5; 3.8 with a tenth of the amplitude).
Outcome manufactured_solution() {
  Outcome outcome;
  const double coarse = manufactured_error(16, 4, outcome), middle = manufactured_error(32, 4, outcome),
               fine = manufactured_error(64, 4, outcome);
  const double sparse = manufactured_error(32, 2, outcome) / manufactured_error(64, 2, outcome);
  outcome.checks = {within("L2 error, 16 over 32 cells, four points a cell [1]", coarse / middle, 3.3, 10),
                    within("L2 error, 32 over 64 cells, four points a cell [1]", middle / fine, 3.3, 10),
                    within("L2 error, 32 over 64 cells, two points a cell [1]", sparse, 2, 10),
                    absolute("L2 error, 64 cells, four points a cell [amplitude]", fine, 0, 0.001)};
  return outcome;
}

StudyPoint displacement_error(int cells) {
  Outcome outcome;
  const double error = manufactured_error(cells, 4, outcome);
  return {error, outcome.particle_steps};
}

}  // namespace

std::vector<Problem> vibration() {
  return {{"A5", "Free vibration of a bar, fixed at one end", "closed form T = 4L/c", bar_vibration,
           Study{"period [4L/c]", "cells along the bar", {16, 32, 64}, 0.8, period_error}},
          {"A6", "Energy drift over a period of that bar", "conservation", energy_drift},
          {"A7", "Elastic rod on a rigid wall", "wave theory: F = A v sqrt(E rho), 2L/c", rod_on_wall},
          {"A9", "Cantilever under a load at its tip", "Euler, Timoshenko", cantilever,
           Study{"period of the first mode [Euler]", "cells in its depth", {3, 6, 12}, 0.8, beam_period_error}},
          {"A10", "Manufactured solution in a bar", "closed form; Wallstedt and Guilkey 2008", manufactured_solution,
           Study{"displacement, L2 [amplitude]", "cells along the bar", {16, 32, 64}, 1.72, displacement_error}}};
}

}  // namespace sunder::validation::detail
