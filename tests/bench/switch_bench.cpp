/// What the solver's own switches buy and what they cost, on the first fractures of scenes: processor time over that of
/// the defaults, and how far the cracks are from those of the defaults, beside how far two seeds are from each other.
///     switch_bench [--json FILE] [--particles N] [SCENE...]
#include <cstdio>
#include <functional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "core/resources.h"
#include "geometry/mass_properties.h"
#include "output/atomic_file.h"
#include "pipeline/accuracy_measures.h"
#include "pipeline/scene.h"
#include "pipeline/simulation.h"

namespace {

using namespace sunder;
using namespace sunder::pipeline;

struct Switch {
  std::string name, setting;
  std::function<void(FractureInput&)> turn;
};

std::vector<Switch> switches() {
  const auto set = [](auto member, auto value) { return [=](FractureInput& input) { input.solve.*member = value; }; };
  using S = mpm::SolveSettings;
  return {{"none", "the defaults", [](FractureInput&) {}},
          {"none", "another seed", [](FractureInput& i) { i.seed = ++i.solve.seed; }},
          {"none", "a third seed", [](FractureInput& i) { i.seed = i.solve.seed += 2; }},
          {"time step", "0.1 h/c", set(&S::cfl, 0.1)},
          {"time step", "0.2 h/c", set(&S::cfl, 0.2)},
          {"time step", "0.35 h/c (default)", set(&S::cfl, 0.35)},
          {"time step", "0.6 h/c", set(&S::cfl, 0.6)},
          {"time step", "0.9 h/c", set(&S::cfl, 0.9)},
          {"early stop", "quiet for 1 transit", set(&S::quiet_transits, 1.0)},
          {"early stop", "quiet for 2 transits (default)", set(&S::quiet_transits, 2.0)},
          {"early stop", "quiet for 6 transits", set(&S::quiet_transits, 6.0)},
          {"longest solve", "2 transits after the contact", set(&S::most_transits, 2.0)},
          {"longest solve", "4 transits", set(&S::most_transits, 4.0)},
          {"longest solve", "8 transits (default)", set(&S::most_transits, 8.0)},
          {"longest solve", "16 transits", set(&S::most_transits, 16.0)},
          {"splines", "cubic", set(&S::spline, mpm::Spline::cubic)},
          {"crack sides", "two velocity fields", set(&S::two_fields, true)},
          {"energy ledger", "off", set(&S::energy_ledger, false)},
          {"viscosity", "none", set(&S::viscosity, 0.0)},
          {"crack lattice", "node spacing 1.2 particle spacings",
           [](FractureInput& i) {
             i.crack.node_spacing = 1.2 * std::cbrt(geometry::mass_properties(i.mesh).volume / i.particles);
           }},
          {"damage law", "local", set(&S::damage, mpm::DamageModel::local)},
          {"load", "prescribed", set(&S::load, mpm::LoadModel::prescribed)}};
}

struct Measured {
  FractureTrace trace;
  double seconds = 0;
  std::size_t pieces = 1;
};

Measured measure(FractureInput input, const Switch& s, int particles) {
  input.particles = particles;
  input.crack.detail.clear();
  input.crack.hairline_width = 0;
  s.turn(input);
  SilentProgress progress;
  const double start = cpu_seconds();
  const FractureOutcome outcome = fracture(input, progress);
  return {trace_of(input, outcome), cpu_seconds() - start, std::max<std::size_t>(1, outcome.pieces.size())};
}

nlohmann::ordered_json study(const std::string& file, int particles) {
  const Scene scene = load_scene(file);
  const RunOptions options;
  SilentProgress progress;
  Simulation simulation(scene, options, progress);
  const auto hits = simulation.rehearse(1, progress);
  nlohmann::ordered_json rows = nlohmann::ordered_json::array();
  if (hits.empty()) return rows;
  const std::vector<Switch> all = switches();
  const Measured base = measure(hits[0].input, all[0], particles);
  std::printf("%s: %s, %d particles\n", scene.name.c_str(), hits[0].body.c_str(), particles);
  for (const Switch& s : all) {
    const Measured m = measure(hits[0].input, s, particles);
    const TraceDistance d = distance(m.trace, base.trace);
    std::printf("  %-15s %-36s %5.2f x time, %3zu pieces, cracks %.4f, damage %.3f, force %.3f\n", s.name.c_str(),
                s.setting.c_str(), m.seconds / base.seconds, m.pieces, d.crack_mean.value_or(-1), d.damage,
                m.trace.peak_force / base.trace.peak_force);
    std::fflush(stdout);
    rows.push_back({{"switch", s.name},
                    {"setting", s.setting},
                    {"time", m.seconds / base.seconds},
                    {"pieces", m.pieces},
                    {"crack_mean", d.crack_mean ? nlohmann::ordered_json(*d.crack_mean) : nullptr},
                    {"damage", d.damage},
                    {"peak_force", m.trace.peak_force / base.trace.peak_force}});
  }
  return {{"scene", scene.name}, {"particles", particles}, {"rows", rows}};
}

}  // namespace

int main(int argc, char** argv) {
  std::string json;
  int particles = 20000;
  std::vector<std::string> scenes;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    if (word == "--json" && i + 1 < argc)
      json = argv[++i];
    else if (word == "--particles" && i + 1 < argc)
      particles = std::atoi(argv[++i]);
    else
      scenes.push_back(word);
  }
  if (scenes.empty())
    for (const char* name : {"cup_drop", "plate_ball", "pot_drop"})
      scenes.push_back(std::string(SUNDER_SOURCE_DIR) + "/assets/scenes/" + name + ".toml");
  nlohmann::ordered_json studies = nlohmann::ordered_json::array();
  for (const std::string& scene : scenes) studies.push_back(study(scene, particles));
  if (!json.empty()) output::write_atomically(json, nlohmann::ordered_json{{"scenes", studies}}.dump(2) + "\n");
  return 0;
}
