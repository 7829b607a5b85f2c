#include <algorithm>
#include <cmath>

#include "pipeline/detail/hard_cases.h"
#include "pipeline/hard_cases.h"

namespace sunder::pipeline {
namespace {

using validation::absolute;
using validation::Outcome;
using validation::within;

/// Two plates that fly into each other, weightless, so that nothing else changes what fragments take over.
constexpr const char* flying_plates = R"([scene]
duration = 0.1
frame_rate = 60
gravity = [0, 0, 0]
quality = "draft"
[[body]]
name = "left"
mesh = "box"
size = [0.1, 0.02, 0.1]
anchor = "centre"
rotation = [0, 0, 90]
position = [-0.1, 0, 0]
velocity = [12, 0, 0]
material = "glass"
[[body]]
name = "right"
mesh = "box"
size = [0.08, 0.03, 0.1]
anchor = "centre"
rotation = [10, 0, 70]
position = [0.1, 0.03, 0.01]
velocity = [-9, 0, 1]
angular_velocity = [0, 0, 3]
material = "porcelain"
)";

/// D4
Outcome hand_over() {
  Outcome outcome;
  const RunResult r = detail::sound_run(flying_plates, "two plates in flight", outcome);
  double momentum = 0, gained = 0, broken = 0;
  for (const FractureRecord& f : r.report.fractures) {
    broken += f.fragments > 0;
    momentum = std::max(momentum, f.momentum_error);
    if (f.kinetic_before > 0) gained = std::max(gained, f.kinetic_after / f.kinetic_before - 1);
  }
  double born = 0, parents = 0;
  for (const output::Piece& p : r.sequence.pieces) {
    if (p.generation > 0 && std::isinf(p.death_time)) born += p.mass;
    if (p.generation == 0 && std::isfinite(p.death_time)) parents += p.mass;
  }
  outcome.checks.push_back(within("fractures", broken, 1, 10));
  outcome.checks.push_back(absolute("momentum and angular momentum lost in them [what there was]", momentum, 0, 1e-9));
  outcome.checks.push_back(within("kinetic energy won in one [what there was]", gained, -1, 1e-9));
  outcome.checks.push_back(absolute("mass of the fragments [bodies that broke]", born / parents, 1, 1e-9));
  return outcome;
}

}  // namespace

const std::vector<validation::Problem>& catalogue() {
  static const std::vector<validation::Problem> all = [] {
    std::vector<validation::Problem> list = validation::problems();
    const validation::Problem problem{"D4", "Hand-over of motion to the fragments", "conservation", hand_over};
    const auto after = std::find_if(list.begin(), list.end(), [](const auto& p) { return p.id > "D4"; });
    list.insert(after, problem);
    return list;
  }();
  return all;
}

}  // namespace sunder::pipeline
