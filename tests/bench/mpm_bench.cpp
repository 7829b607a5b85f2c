/// Speed, memory and quality of the damage solve: one table, and with --json FILE the same numbers by key. Ratios are
/// taken in one run; rates are the median of several.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <functional>
#include <stdexcept>
#include <string>

#include <nlohmann/json.hpp>
#include <tbb/global_control.h>
#include <unistd.h>

#include "mpm/contact_load.h"
#include "mpm/crack_growth.h"
#include "pipeline/run.h"
#include "pipeline/scene.h"
#include "tests/mpm/bodies.h"
#include "tests/mpm/reference_step.h"
#include "validation/problem.h"

namespace {

using namespace sunder;
using namespace sunder::mpm;
namespace fs = std::filesystem;

double seconds_of(const std::function<void()>& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

// ---- a cube in equal biaxial tension ------------------------------------------------------------------------------

/// What every particle of the cube has to do in every step.
enum class Work {
  elastic,     ///< far below its threshold: no eigenvalues
  eigenvalue,  ///< the cheap bound exceeds the threshold, the largest principal stress does not
  split,       ///< damaged: eigenvalues and the tensile part of the stress
};

constexpr double cell = 0.01, strain = 1e-4;

/// Time stands nearly still, so that the state stays as it is however long the clock runs.
Continuum cube(int edge, Work work, Spline spline = Spline::quadratic) {
  const Material material{
      .density = 1000, .youngs_modulus = 3e9, .poisson_ratio = 0.3, .tensile_strength = 1e6, .fracture_energy = 10};
  const double spacing = cell / 2;
  const fixture::Body body = fixture::block(Vec3::Constant(0.5 * edge * spacing), spacing, 0.25);
  ContinuumSettings settings;
  settings.cell_size = cell;
  settings.time_step = 1e-11;
  settings.viscosity = 0.1 * material.density * material.p_wave_speed() * cell;
  settings.anchor = Vec3::Constant(-0.5 * edge * spacing + 0.3 * cell);
  settings.spline = spline;
  Continuum result(body.points, spacing * spacing * spacing, material, settings);
  const double nu = material.poisson_ratio, stress = material.youngs_modulus / (1 - nu) * strain;
  for (int id = 0; id < result.size(); ++id) {
    PointState p = result.point(id);
    p.displacement_gradient = Vec3(strain, strain, -2 * nu / (1 - nu) * strain).asDiagonal();
    // The bound of equal biaxial tension s is 4/3 s.
    p.threshold = p.strength = work == Work::elastic ? 1e15 : 1.1 * stress;
    p.softening_slope = 0.1;
    p.damage = work == Work::split ? 0.3 : 0;
    result.set_point(id, p);
  }
  return result;
}

int edge_of(double particles) { return static_cast<int>(std::round(std::cbrt(particles))); }

void step(Continuum& body) {
  body.advance(0);
  body.update_grid();
}

/// Million particle-steps per second.
double rate(Continuum& body, std::size_t threads, int repetitions = 7) {
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
  const int steps = std::max(3, 4000000 / body.size());
  std::vector<double> rates;
  step(body);
  for (int n = 0; n < repetitions; ++n)
    rates.push_back(1e-6 * steps * body.size() / seconds_of([&] {
                      for (int s = 0; s < steps; ++s) step(body);
                    }));
  return median(rates);
}

double rate(double particles, Work work, std::size_t threads, Spline spline = Spline::quadratic) {
  Continuum body = cube(edge_of(particles), work, spline);
  return rate(body, threads);
}

/// The plain step of the tests on the same cube, one thread.
double reference_rate(double particles, Work work) {
  const int edge = edge_of(particles);
  Continuum body = cube(edge, work);
  std::vector<fixture::ReferencePoint> points;
  for (int id = 0; id < body.size(); ++id) points.push_back({body.point(id), {}});
  const Material material{
      .density = 1000, .youngs_modulus = 3e9, .poisson_ratio = 0.3, .tensile_strength = 1e6, .fracture_energy = 10};
  const int nodes = edge / 2 + 8;
  fixture::ReferenceStep reference(material, cell * cell * cell / 8, cell, 1e-11, 1,
                                   Vec3::Constant(-0.25 * edge * cell - 3.2 * cell), {nodes, nodes, nodes});
  std::vector<double> rates;
  for (int n = 0; n < 3; ++n)
    rates.push_back(1e-6 * body.size() * 8 / seconds_of([&] {
                      for (int s = 0; s < 8; ++s) reference(points);
                    }));
  return median(rates);
}

// ---- a plate that breaks ------------------------------------------------------------------------------------------

struct BrokenPlate {
  double front_rules_share = 0;  ///< of the step, while the damage goes from a tenth to nine tenths of what it becomes
  double two_field_cost = 0;     ///< of a step of the broken plate, over that with one field
};

BrokenPlate break_plate() {
  const fixture::Body body = fixture::plate(0.1 / 46);
  const Material material = fixture::glass();
  const Load load = fixture::steel_ball_on_glass({0.013, 0.01, -0.02}, Vec3::UnitY(), 10);
  const Partner partner{fixture::steel_ball_mass(0.01)};
  const SolveSettings settings;
  ContinuumSettings continuum;
  continuum.cell_size = 2 * std::cbrt(body.volume / static_cast<double>(body.points.size()));
  continuum.time_step = settings.cfl * continuum.cell_size / material.p_wave_speed();
  continuum.viscosity = settings.viscosity * material.density * material.p_wave_speed() * continuum.cell_size;
  continuum.anchor = body.points.front();
  Continuum plate(body.points, body.volume / static_cast<double>(body.points.size()), material, continuum);
  CrackGrowth cracks(material, settings, body.points, plate);
  ContactLoad contact(load, material.density * body.volume, partner, material, settings, plate);
  struct Sample {
    long failures;
    double whole, rules;
  };
  std::vector<Sample> samples;
  Vec3 slowed = Vec3::Zero(), displacement = Vec3::Zero();
  for (int n = 0; n < 1200; ++n) {
    const double time = n * continuum.time_step;
    double rules = 0;
    const double whole = seconds_of([&] {
      plate.advance(time);
      rules = seconds_of([&] { cracks.grow(time, plate); });
      contact.evaluate(plate, displacement, time, continuum.time_step);
      slowed += contact.apply(continuum.time_step, plate) / partner.mass;
      displacement += continuum.time_step * slowed;
      plate.update_grid();
    });
    samples.push_back({plate.failures(), whole, rules});
  }
  double whole = 0, rules = 0;
  const double last = static_cast<double>(samples.back().failures);
  for (const Sample& s : samples) {
    if (static_cast<double>(s.failures) < 0.1 * last || static_cast<double>(s.failures) > 0.9 * last) continue;
    whole += s.whole;
    rules += s.rules;
  }
  BrokenPlate result;
  result.front_rules_share = rules / whole;
  const double one_field = rate(plate, 2);
  plate.open(cracks.new_faces(plate), settings.crack_friction);
  result.two_field_cost = one_field / rate(plate, 2);
  return result;
}

// ---- quality ------------------------------------------------------------------------------------------------------

/// The check of a validation problem whose description begins like this.
double checked(const std::string& id, const std::string& what) {
  for (const auto& problem : validation::problems()) {
    if (problem.id != id) continue;
    for (const auto& check : problem.run().checks)
      if (check.what.starts_with(what)) return check.value;
  }
  throw std::logic_error("no check '" + what + "' in problem " + id);
}

/// Largest share of a body that is damaged far from everything sound, over all fractures of the scenes that come with
/// Sunder.
double worst_lump_share() {
  double worst = 0;
  const fs::path out = fs::temp_directory_path() / ("sunder_bench_" + std::to_string(getpid()));
  for (const auto& entry : fs::directory_iterator(fs::path(SUNDER_SOURCE_DIR) / "assets/scenes")) {
    if (entry.path().extension() != ".toml") continue;
    pipeline::RunOptions options;
    options.out = out;
    SilentProgress progress;
    const auto result = pipeline::run(pipeline::load_scene(entry.path()), options, progress);
    for (const auto& fracture : result.report.fractures) worst = std::max(worst, fracture.lump_share);
    fs::remove_all(out);
  }
  return worst;
}

// ---- table --------------------------------------------------------------------------------------------------------

struct Table {
  nlohmann::ordered_json json;

  void add(const char* key, double value, const char* unit, const char* what) {
    json[key] = value;
    std::printf("%-28s %9.3g %-5s %s\n", key, value, unit, what);
    std::fflush(stdout);
  }
};

}  // namespace

int main(int argc, char** argv) {
  std::string file;
  if (argc == 3 && std::string(argv[1]) == "--json")
    file = argv[2];
  else if (argc != 1)
    return std::fprintf(stderr, "usage: mpm_bench [--json FILE]\n"), 2;

  Table table;
  table.json["instruction_set"] = name_of(best_instruction_set());
  std::printf("%s\n", name_of(best_instruction_set()));
  const double full = rate(16384, Work::eigenvalue, 2);
  table.add("full_step_16k_2t_mps", full, "Mp/s", "neo-Hookean, eigenvalue of every particle");
  table.add("elastic_16k_2t_mps", rate(16384, Work::elastic, 2), "Mp/s", "no particle near its threshold");
  table.add("jacobi_16k_2t_mps", rate(16384, Work::split, 2), "Mp/s", "tension split of every particle");
  table.add("cubic_16k_2t_mps", rate(16384, Work::eigenvalue, 2, Spline::cubic), "Mp/s", "cubic splines");
  table.add("ratio_to_reference_1t", rate(16384, Work::split, 1) / reference_rate(16384, Work::split), "",
            "same problem in the plain step of the tests");
  Continuum large = cube(edge_of(128 * 1024), Work::eigenvalue), huge = cube(edge_of(1024 * 1024), Work::eigenvalue);
  table.add("rate_1m_over_16k", rate(huge, 2) / full, "", "full step, 2 threads");
  table.add("scaling_2t", rate(large, 2) / rate(large, 1), "", "128 k particles");
  table.add("bytes_per_particle", static_cast<double>(large.memory()) / large.size(), "B", "grid included");
  const BrokenPlate plate = break_plate();
  table.add("two_field_cost", plate.two_field_cost, "", "step of a broken plate over that with one field, 20 k");
  table.add("front_rules_share", plate.front_rules_share, "", "of the step while damage grows, 20 k");
  const std::string energy = "energy per crack area";
  const double plate_energy = checked("B5", energy), bar_energy = checked("B14", "energy release rate");
  const bool plate_worse = std::abs(std::log(plate_energy)) > std::abs(std::log(bar_energy));
  table.add("energy_over_gf", plate_worse ? plate_energy : bar_energy, "", "the worse of the next two");
  table.add("energy_over_gf_plate", plate_energy, "", "at which the edge crack of a plate runs (B5)");
  table.add("energy_over_gf_bar", bar_energy, "", "at which a double cantilever beam splits (B14)");
  table.add("worst_lump_share", worst_lump_share(), "", "of all fractures of the scenes that come with Sunder");
  if (file.empty()) return 0;
  std::ofstream(file) << table.json.dump(2) << "\n";
  return 0;
}
