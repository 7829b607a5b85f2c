#include <algorithm>
#include <cmath>
#include <cstdio>

#include "geometry/cut.h"
#include "geometry/mass_properties.h"
#include "geometry/primitives.h"
#include "pipeline/detail/hard_cases.h"
#include "pipeline/hard_cases.h"
#include "pipeline/lifecycle.h"
#include "rigid/world.h"

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

/// A run, and how much it breaks of what every run must hold (sound_run). Names of checks are the same on all machines,
/// which may differ in the number of pieces.
RunResult checked_run(const std::string& toml, const std::string& what, Outcome& outcome) {
  Outcome sound;
  RunResult result = detail::sound_run(toml, what, sound);
  const auto failed =
      std::count_if(sound.checks.begin(), sound.checks.end(), [](const auto& c) { return !c.passed(); });
  outcome.particle_steps += sound.particle_steps;
  outcome.checks.push_back(
      absolute(what + ": of finite poses, closed pieces, volume, energy, not kept", static_cast<double>(failed), 0, 0));
  return result;
}

/// D4
Outcome hand_over() {
  Outcome outcome;
  const RunResult r = checked_run(flying_plates, "two plates in flight", outcome);
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

/// A crack all round a ball in the middle of a body.
geometry::RegionBoundary round_crack(const Vec3& centre, double radius) {
  const geometry::TriangleMesh ball = geometry::transformed(geometry::sphere(radius), Mat3::Identity(), centre);
  geometry::RegionBoundary regions;
  regions.vertices = ball.vertices;
  regions.region_count = 2;
  for (const geometry::Triangle& t : ball.faces) regions.faces.push_back({{t[0], t[1], t[2]}, 0, 1});
  return regions;
}

rigid::BodySetup setup_of(const geometry::TriangleMesh& mesh, double whole_volume) {
  constexpr double density = 2400;
  const geometry::MassProperties m = geometry::mass_properties(mesh);
  const geometry::TriangleMesh centred = geometry::transformed(mesh, Mat3::Identity(), -m.centroid);
  rigid::BodySetup setup;
  setup.hulls = geometry::convex_parts(centred, collision_detail(size_class(m.volume / whole_volume, {}))).hulls;
  setup.mass = density * m.volume;
  setup.inertia = density * m.inertia;
  setup.pose.position = m.centroid;
  setup.family = 1;
  return setup;
}

/// A cube of this size that stands on the ground, and a ball in its void.
struct Restlessness {
  double speed = 0;  ///< largest in five seconds [sqrt(g size)]
  double drift = 0;  ///< after five seconds [size]
};
Restlessness ball_in_cube(double size, double off_centre) {
  const geometry::TriangleMesh body =
      geometry::transformed(geometry::box(Vec3::Constant(size)), Mat3::Identity(), Vec3(0, size / 2, 0));
  SilentProgress progress;
  const geometry::CutResult cut =
      geometry::cut(body, round_crack(Vec3(off_centre * size, size / 2, 0), 0.3 * size), {}, progress);
  rigid::WorldSettings settings;
  settings.has_ground = true;
  rigid::World world(settings);
  std::vector<Vec3> places;
  for (const geometry::Fragment& fragment : cut.fragments) {
    const rigid::BodySetup setup = setup_of(fragment.mesh, size * size * size);
    places.push_back(setup.pose.position);
    world.add(setup);
  }
  Restlessness result;
  if (places.size() != 2) result.drift = std::numeric_limits<double>::infinity();
  for (int step = 0; step < 5 * 480; ++step) {
    world.step();
    for (const rigid::BodyId id : world.bodies())
      result.speed = std::max(result.speed, world.state(id).twist.linear.norm() / std::sqrt(9.81 * size));
  }
  for (const rigid::BodyId id : world.bodies()) {
    const Vec3 moved = world.state(id).pose.position - places[static_cast<std::size_t>(id)];
    result.drift = std::max(result.drift, moved.norm() / size);
  }
  return result;
}

/// D7b. A body in the void of another, as a closed crack leaves it (C4): the hulls of the outer one bulge into the
/// void.
Outcome body_in_a_void() {
  Outcome outcome;
  for (const double size : {0.02, 0.1, 1.0}) {
    Restlessness worst;
    for (const double off_centre : {0.0, 0.1}) {
      const Restlessness r = ball_in_cube(size, off_centre);
      worst = {std::max(worst.speed, r.speed), std::max(worst.drift, r.drift)};
    }
    char name[64];
    std::snprintf(name, sizeof name, "cube of %g m, 5 s: ", size);
    // A jolt would be a speed of some sqrt(g size).
    outcome.checks.push_back(absolute(name + std::string("largest speed [sqrt(g size)]"), worst.speed, 0, 0.02));
    outcome.checks.push_back(absolute(name + std::string("drift [size]"), worst.drift, 0, 1e-3));
  }
  return outcome;
}

/// D8b. Solved if the impulse reaches the threshold, and once: three runs, two with thresholds about the impulse that
/// the first one met.
Outcome threshold() {
  const auto drop = [](double least_impulse) {
    char number[32];
    std::snprintf(number, sizeof number, "%.17g", least_impulse);
    return R"([scene]
duration = 0.017
frame_rate = 60
quality = "draft"
[ground]
[[body]]
name = "ball"
mesh = "sphere"
height = 0.1
position = [0, 0.001, 0]
velocity = [0, -3, 0]
material = "plaster"
[fracture]
minimum_impulse = )" +
           std::string(number) + "\n";
  };
  Outcome outcome;
  const RunResult first = checked_run(drop(1e-3), "no threshold", outcome);
  const auto& solves = first.report.fractures;
  outcome.checks.push_back(absolute("no threshold: solves", static_cast<double>(solves.size()), 1, 0));
  if (solves.empty()) return outcome;
  const double impulse = solves[0].impulse, momentum = 3 * first.sequence.pieces[0].mass;
  outcome.checks.push_back(within("impulse of the ground [momentum of the ball]", impulse / momentum, 1, 2));
  for (const double factor : {0.999, 1.001}) {
    char name[64];
    std::snprintf(name, sizeof name, "threshold of %g impulses", factor);
    const RunResult r = checked_run(drop(factor * impulse), name, outcome);
    outcome.checks.push_back(absolute(name + std::string(": solves"), static_cast<double>(r.report.fractures.size()),
                                      factor < 1 ? 1 : 0, 0));
  }
  return outcome;
}

}  // namespace

const std::vector<validation::Problem>& catalogue() {
  static const std::vector<validation::Problem> all = [] {
    std::vector<validation::Problem> list = validation::problems();
    for (const validation::Problem& problem :
         {validation::Problem{"D4", "Hand-over of motion to the fragments", "conservation", hand_over},
          validation::Problem{"D7b", "Body in the void of another", "rest", body_in_a_void},
          validation::Problem{"D8b", "Threshold of the impulse", "the impulse of a run without it", threshold}}) {
      // Among problems of D: their numbers have one digit.
      const auto after = std::find_if(list.begin(), list.end(), [&](const auto& p) { return p.id > problem.id; });
      list.insert(after, problem);
    }
    return list;
  }();
  return all;
}

}  // namespace sunder::pipeline
