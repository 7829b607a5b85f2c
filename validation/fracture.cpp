#include <cmath>
#include <numbers>

#include "validation/catalogue.h"
#include "validation/specimen.h"

namespace sunder::validation {
namespace {

using std::numbers::pi;

/// B5: plane strain, edge crack of a quarter of the width, pulled slowly until the crack is through.
struct EdgeCrack {
  double strength = 0;    ///< largest mean stress over that of Griffith
  double dissipated = 0;  ///< by damage, over G_f x area
  double band = 0;        ///< mean thickness of the damage [h]
  double particle_steps = 0;
};

/// Tada: K = Y sigma sqrt(pi a).
double tada(double s) { return 1.12 - 0.231 * s + 10.55 * s * s - 21.72 * s * s * s + 30.39 * s * s * s * s; }

EdgeCrack pull_edge_crack(int cells, double band_over_admissible) {
  constexpr double width = 0.1, crack = width / 4;
  const double h = width / cells;
  mpm::Material m{.density = 2450, .youngs_modulus = 32e9, .poisson_ratio = 0.2, .fracture_energy = 3};
  SpecimenSettings settings;
  // l_max = 2 E G_f / sigma_f^2.
  m.tensile_strength =
      std::sqrt(2 * m.youngs_modulus * m.fracture_energy * band_over_admissible / (settings.solve.band_width * h));
  const double plane_modulus = m.youngs_modulus / (1 - m.poisson_ratio * m.poisson_ratio);
  const double griffith = std::sqrt(plane_modulus * m.fracture_energy / (pi * crack)) / tada(crack / width);
  const double transit = width / m.p_wave_speed(), rate = griffith / plane_modulus / (6 * transit);
  settings.damage = Damage::front;
  settings.plane_strain = true;
  settings.viscosity = settings.solve.viscosity;
  const Vec3 far = Vec3::Constant(1), pull(0, 0.5 * rate * width, 0);
  settings.held = {{Box(-far, Vec3(1, 0.5001 * h, 1)), -pull, {false, true, false}},
                   {Box(Vec3(-1, width - 0.5001 * h, -1), far), pull, {false, true, false}}};
  settings.velocity_gradient(1, 1) = rate;
  const auto off_plane = [&](const Vec3& x) { return std::abs(x[1] - 0.5 * width); };
  const Lattice lattice = plane(
      Box(Vec3::Zero(), Vec3(width, width, 0)), h, [&](const Vec3& x) { return x[0] > crack || off_plane(x) > h; },
      0.2);
  Specimen specimen(lattice, m, settings);
  const auto tip = [&](const Vec3& x) { return x[0] < crack + 0.5 * h && off_plane(x) < 0.6 * h; };
  specimen.crack(tip, Vec3::UnitY());
  const long seeds = specimen.failed();

  EdgeCrack result;
  double reach = 0;
  while (reach < width - 0.6 * h && specimen.time() < 24 * transit) {
    for (int n = 0; n < 50; ++n) specimen.step();
    result.strength = std::max(result.strength, specimen.force(1)[1] / (width * h) / griffith);
    for (int id = 0; id < specimen.body.size(); ++id)
      if (specimen.body.point(id).damage > mpm::failed_damage)
        reach = std::max(reach, specimen.body.material_position(id)[0]);
  }
  const double area = (width - crack) * h;
  result.dissipated = specimen.dissipated() / (m.fracture_energy * area);
  result.band = static_cast<double>(specimen.failed() - seeds) * lattice.particle_volume / area / h;
  result.particle_steps = specimen.particle_steps();
  if (reach < width - 0.6 * h) result.strength = std::numeric_limits<double>::quiet_NaN();
  return result;
}

Outcome edge_crack() {
  Outcome outcome;
  double least = 1e9, most = 0;
  for (int cells : {64, 96}) {
    const EdgeCrack r = pull_edge_crack(cells, 5);
    outcome.checks.push_back(
        relative("strength over Griffith, " + std::to_string(cells) + " cells", r.strength, 1, 0.2));
    outcome.particle_steps += r.particle_steps;
    least = std::min(least, r.strength);
    most = std::max(most, r.strength);
    if (cells == 96) {
      // The energy release rate at which the crack runs, which is what a crack costs; damage itself takes the smaller
      // part, the rest goes as the tip snaps open.
      outcome.checks.push_back(relative("energy per crack area over G_f", r.strength * r.strength, 1, 0.15));
      outcome.checks.push_back(within("of it by damage", r.dissipated, 0.2, 1));
      outcome.checks.push_back(within("thickness of the damage [h]", r.band, 1, 2.5));
    }
  }
  outcome.checks.push_back(relative("strength, 96 over 64 cells", most / least, 1, 0.1));
  return outcome;
}

}  // namespace

std::vector<Problem> fracture() {
  return {
      {"B5", "Edge crack in a plate, brittle (band 5 l_max): strength", "Tada, Paris, Irwin; Griffith", edge_crack}};
}

}  // namespace sunder::validation
