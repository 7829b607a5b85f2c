#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include <Eigen/Geometry>
#include <tbb/global_control.h>

#include "crack/shatter.h"
#include "geometry/convex_parts.h"
#include "geometry/mass_properties.h"
#include "geometry/primitives.h"
#include "validation/catalogue.h"
#include "validation/damage_cloud.h"
#include "validation/moving_bodies.h"

namespace sunder::validation {
namespace {

using namespace rigid;
using namespace rigid::setup;
using std::numbers::pi;

constexpr double gravity = 9.81;
/// Edges and diameters of bodies [m].
constexpr double sizes[] = {0.005, 0.02, 0.1, 1};

/// The value that is farthest from its reference.
class Farthest {
 public:
  explicit Farthest(double reference) : reference_(reference), value_(reference) {}
  void take(double value) {
    if (!(std::abs(value - reference_) <= std::abs(value_ - reference_))) value_ = value;
  }
  double value() const { return value_; }

 private:
  double reference_, value_;
};

/// Distance of a thrown body from its parabola after a second. Symplectic Euler falls n (n + 1) / 2 steps instead of
/// n^2 / 2, which makes g t dt / 2.
double parabola_error(double time_step) {
  WorldSettings settings;
  settings.time_step = time_step;
  World world(settings);
  BodySetup setup = box(Vec3(0.1, 0.2, 0.3), Vec3(1, 2, 3));
  setup.twist.linear = Vec3(0.5, 4, -0.25);
  const BodyId id = world.add(setup);
  run(world, 1, time_step);
  const Vec3 exact = setup.pose.position + setup.twist.linear + settings.gravity / 2;
  return (world.state(id).pose.position - exact).norm();
}

StudyPoint parabola_study(int steps_per_second) { return {parabola_error(1.0 / steps_per_second), 0}; }

struct Top {
  double energy_drift = 0, momentum_drift = 0;
  std::vector<double> flips;  ///< times at which the middle axis changes sides [s]
};

Top spin_top(const Vec3& moments, const Vec3& angular, double seconds) {
  WorldSettings settings = weightless();
  settings.time_step = 1e-3;
  World world(settings);
  BodySetup setup = box(Vec3(0.3, 0.2, 0.1), Vec3::Zero());
  setup.mass = 6;
  setup.inertia = moments.asDiagonal();
  setup.twist.angular = angular;
  const BodyId id = world.add(setup);
  const double energy = kinetic_energy(world);
  const Vec3 momentum = world.world_inertia(id) * angular;
  Top top;
  double sign = 1;
  for (int i = 0; i < std::lround(seconds / settings.time_step); ++i) {
    world.step();
    const BodyState state = world.state(id);
    top.energy_drift = std::max(top.energy_drift, std::abs(kinetic_energy(world) / energy - 1));
    top.momentum_drift = std::max(top.momentum_drift,
                                  (world.world_inertia(id) * state.twist.angular - momentum).norm() / momentum.norm());
    const double along = (state.pose.orientation.conjugate() * state.twist.angular).y();
    if (along * sign < 0) top.flips.push_back(world.time()), sign = -sign;
  }
  return top;
}

/// Euler's equations in body axes by RK4.
std::vector<double> euler_flips(const Vec3& moments, Vec3 w, double seconds, double dt) {
  const auto rate = [&](const Vec3& x) { return Vec3(-x.cross(moments.cwiseProduct(x)).cwiseQuotient(moments)); };
  std::vector<double> flips;
  double sign = 1;
  for (int i = 0; i < std::lround(seconds / dt); ++i) {
    const Vec3 a = rate(w), b = rate(w + dt / 2 * a), c = rate(w + dt / 2 * b), d = rate(w + dt * c);
    w += dt / 6 * (a + 2 * b + 2 * c + d);
    if (w.y() * sign < 0) flips.push_back((i + 1) * dt), sign = -sign;
  }
  return flips;
}

/// D1
Outcome free_flight() {
  constexpr double dt = 1.0 / 480;
  const Vec3 moments(1, 2, 3), tumbling(0.01, 5, 0.01);
  const Top top = spin_top(moments, Vec3(1, 5, 0.5), 10), flipping = spin_top(moments, tumbling, 10);
  const std::vector<double> expected = euler_flips(moments, tumbling, 10, 1e-4);
  const bool flips = flipping.flips.size() >= 2 && expected.size() >= 2;
  Outcome outcome;
  outcome.checks = {
      absolute("thrown for a second: distance from the parabola [g t dt / 2]", parabola_error(dt) / (gravity * dt / 2),
               1, 1e-8),
      absolute("free top for 10 s: drift of the energy [1]", top.energy_drift, 0, 1e-6),
      absolute("free top: drift of the angular momentum [1]", top.momentum_drift, 0, 1e-10),
      relative("about the middle axis: time between flips [Euler's equations]",
               flips ? flipping.flips[1] - flipping.flips[0] : 0, flips ? expected[1] - expected[0] : 1, 0.02)};
  return outcome;
}

/// Relative errors of a polyhedron's volume and moment of inertia about y, and where its centre of mass is.
struct MassError {
  double volume = 0, inertia = 0, centre = 0;
};
MassError mass_error(const geometry::TriangleMesh& mesh, double volume, double inertia) {
  // Far from the origin, where integrals about it would lose digits.
  const Vec3 shift(30, -20, 10);
  const geometry::MassProperties m = geometry::mass_properties(geometry::transformed(mesh, Mat3::Identity(), shift));
  return {std::abs(m.volume / volume - 1), std::abs(m.inertia(1, 1) / inertia - 1), (m.centroid - shift).norm()};
}

MassError sphere_error(int subdivisions) {
  const double volume = 4 * pi / 3;
  return mass_error(geometry::sphere(1, subdivisions), volume, 0.4 * volume);
}

/// D2
Outcome mass_properties() {
  const MassError block = mass_error(geometry::box(Vec3(1, 2, 3)), 6, 6.0 / 12 * (1 + 9));
  const MassError coarse = sphere_error(3), fine = sphere_error(4);
  constexpr double ring = 1, tube = 0.3;
  // A polygon of n corners that revolves over m segments: Pappus' theorem with the ring's polygon. Every slice across
  // the axis is a pair of similar polygons.
  constexpr int m = 96, n = 32;
  const double swept = n / 2.0 * tube * tube * std::sin(2 * pi / n) * ring * m * std::sin(2 * pi / m);
  const double round = 2 * pi * pi * ring * tube * tube;
  const MassError polygonal = mass_error(geometry::torus(ring, tube, m, n), swept, 1);
  const MassError torus =
      mass_error(geometry::torus(ring, tube, 4 * m, 4 * n), round, round * (ring * ring + 0.75 * tube * tube));
  Outcome outcome;
  outcome.checks = {
      absolute("box: volume [exact]", block.volume, 0, 1e-12),
      absolute("box: moment of inertia [exact]", block.inertia, 0, 1e-12),
      absolute("box: centre of mass [m]", block.centre, 0, 1e-12),
      within("sphere: order of the volume in the edge length", std::log2(coarse.volume / fine.volume), 1.98, 2.02),
      within("sphere: order of the moment of inertia", std::log2(coarse.inertia / fine.inertia), 1.95, 2.05),
      absolute("torus of 96 x 32: volume [that of the polyhedron]", polygonal.volume, 0, 1e-12),
      absolute("torus of 96 x 32: centre of mass [m]", polygonal.centre, 0, 1e-12),
      absolute("torus of 384 x 128: volume [that of a round one]", torus.volume, 0, 1e-3),
      absolute("torus of 384 x 128: moment of inertia [that of a round one]", torus.inertia, 0, 1e-3)};
  return outcome;
}

StudyPoint sphere_volume_error(int faces_along) {
  // Each subdivision halves the edges.
  return {sphere_error(static_cast<int>(std::lround(std::log2(faces_along)))).volume, 0};
}

/// A ball that falls on the ground.
struct Bounces {
  std::vector<double> heights;  ///< of one bounce after the other [fall]
  double end = 0;               ///< when it moves no more [s]
};
Bounces bounces(double restitution, double size, double drop, double seconds) {
  World world(on_ground(restitution));
  BodySetup setup = ball(size / 2, Vec3(0, size / 2 + drop, 0));
  setup.restitution = 1;
  const BodyId id = world.add(setup);
  Bounces result;
  double before = 0;
  while (world.time() < seconds) {
    world.step();
    const BodyState s = world.state(id);
    const double speed = s.twist.linear.y();
    if (before > 1e-6 && speed <= 0) result.heights.push_back((s.pose.position.y() - size / 2) / drop);
    if (std::abs(speed) > 0.05) result.end = world.time();
    before = speed;
  }
  return result;
}

/// Acceleration down a slope; gravity is tilted instead of the ground [m/s^2].
double slide(double angle, double friction, double size) {
  WorldSettings settings = on_ground(0, friction);
  settings.gravity = gravity * Vec3(std::sin(angle), -std::cos(angle), 0);
  World world(settings);
  BodySetup setup = box(Vec3(size, size / 4, size), Vec3(0, size / 4, 0));
  setup.friction = friction;
  const BodyId id = world.add(setup);
  run(world, 0.5);
  return world.state(id).twist.linear.x() / 0.5;
}

/// D3. Of bodies of 5 mm to 1 m the worst.
Outcome restitution_and_friction() {
  constexpr double e = 0.5, angle = 0.6, mu = 0.4;
  const double sliding = gravity * (std::sin(angle) - mu * std::cos(angle));
  Farthest first(e * e), second(std::pow(e, 4)), slipped(sliding), stuck(0);
  double plastic = 0;
  for (const double size : sizes) {
    for (const double drop : {0.3, 1.0}) {
      const std::vector<double> heights = bounces(e, size, drop, 2).heights;
      first.take(heights.size() > 0 ? heights[0] : 0);
      second.take(heights.size() > 1 ? heights[1] : 0);
    }
    plastic += static_cast<double>(bounces(0, size, 0.5, 1).heights.size());
    slipped.take(slide(angle, mu, size));
    stuck.take(slide(0.3, mu, size));
  }
  constexpr double fall = 1;
  Outcome outcome;
  outcome.checks = {relative("e = 0.5: height of the first bounce [fall]", first.value(), e * e, 0.05),
                    relative("e = 0.5: height of the second bounce [fall]", second.value(), std::pow(e, 4), 0.05),
                    relative("e = 0.5: all bounces together last [s]", bounces(e, 0.1, fall, 3).end,
                             std::sqrt(2 * fall / gravity) * (1 + e) / (1 - e), 0.05),
                    absolute("e = 0: bounces", plastic, 0, 0),
                    relative("slope of 0.6 rad, mu = 0.4: acceleration [m/s^2]", slipped.value(), sliding, 0.03),
                    absolute("slope of 0.3 rad: acceleration [m/s^2]", stuck.value(), 0, 1e-3)};
  return outcome;
}

/// What a world does in so many steps: all impulses, and where everything is then.
std::pair<std::uint64_t, std::vector<double>> deeds(World& world, int steps) {
  std::vector<double> impulses;
  for (int i = 0; i < steps; ++i)
    for (const Impact& impact : world.step()) impulses.push_back(impact.impulse);
  return {hash(world), impulses};
}

double differing_threads() {
  std::vector<std::pair<std::uint64_t, std::vector<double>>> done;
  for (const std::size_t threads : {1, 2, 4}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    World world = pile(60);
    done.push_back(deeds(world, 300));
  }
  return static_cast<double>((done[1] != done[0]) + (done[2] != done[0]));
}

/// D5. Promised for one build on one kind of machine, for any number of threads. Restored and copied at every stage of
/// the heap: falling, hitting, resting, asleep.
Outcome determinism() {
  World first = pile(30), second = pile(30);
  double differing = 0, restored = 0, copied = 0;
  for (int i = 0; i < 300; ++i) differing += deeds(first, 1) != deeds(second, 1);
  World world = pile(30);
  for (int stage = 0; stage < 12; ++stage) {
    constexpr int steps = 120;
    const World::Snapshot before = world.snapshot();
    World copy(on_ground(), world.state());
    const auto done = deeds(world, steps);
    copied += deeds(copy, steps) != done || copy.bodies() != world.bodies();
    world.restore(before);
    restored += deeds(world, steps) != done;
  }
  Outcome outcome;
  outcome.checks = {absolute("30 bodies, two runs: steps after which they differ", differing, 0, 0),
                    absolute("taken back at 12 moments and run again: runs that differ", restored, 0, 0),
                    absolute("saved and loaded at 12 moments: runs that differ", copied, 0, 0),
                    absolute("60 bodies, two and four threads: runs that differ", differing_threads(), 0, 0)};
  return outcome;
}

/// A solid in flight, and the solids that it breaks into: about the body's centre of mass, of density 1000 kg/m^3.
struct Shattered {
  geometry::MassProperties whole;
  std::vector<geometry::MassProperties> parts;
  std::vector<geometry::TriangleMesh> meshes;
  Twist twist{Vec3(1, -2, 0.5), Vec3(3, 20, -5)};

  Shattered(const geometry::TriangleMesh& body, const geometry::RegionBoundary& cracks)
      : whole(geometry::mass_properties(body)) {
    SilentProgress progress;
    for (const geometry::Fragment& f : geometry::cut(body, cracks, {}, progress).fragments) {
      meshes.push_back(f.mesh);
      parts.push_back(geometry::mass_properties(f.mesh));
    }
  }
  Vec3 velocity(const geometry::MassProperties& part) const { return twist.at(part.centroid - whole.centroid); }

  /// Momentum, angular momentum about the origin and energy of the parts: the largest deviation from those of the body.
  double lost() const {
    Vec3 momentum = Vec3::Zero(), angular = Vec3::Zero();
    double energy = 0;
    for (const geometry::MassProperties& p : parts) {
      momentum += p.volume * velocity(p);
      angular += p.volume * p.centroid.cross(velocity(p)) + p.inertia * twist.angular;
      energy += p.volume * velocity(p).squaredNorm() / 2 + twist.angular.dot(p.inertia * twist.angular) / 2;
    }
    const Vec3 p = whole.volume * twist.linear, l = whole.centroid.cross(p) + whole.inertia * twist.angular;
    const double e = p.dot(twist.linear) / 2 + twist.angular.dot(whole.inertia * twist.angular) / 2;
    return std::max({(momentum - p).norm() / p.norm(), (angular - l).norm() / l.norm(), std::abs(energy / e - 1)});
  }

  World fragments(bool in_motion, int family = 1) const {
    constexpr double density = 1000;
    World world(weightless());
    for (std::size_t i = 0; i < parts.size(); ++i) {
      const Vec3& centre = parts[i].centroid;
      BodySetup setup;
      setup.hulls = geometry::convex_parts(geometry::transformed(meshes[i], Mat3::Identity(), -centre), {}).hulls;
      setup.mass = density * parts[i].volume;
      setup.inertia = density * parts[i].inertia;
      setup.pose.position = centre;
      if (in_motion) setup.twist = {velocity(parts[i]), twist.angular};
      setup.family = family;
      world.add(setup);
    }
    return world;
  }
};

/// A cup in flat cells.
Shattered shattered_cup() {
  const geometry::TriangleMesh cup = geometry::cup(0.1, 0.006);
  const Box space = geometry::bounds(cup);
  std::vector<Vec3> sites;
  for (std::uint64_t i = 0; i < 20; ++i)
    sites.push_back(space.min() +
                    Vec3(random_unit(4, 0, i), random_unit(4, 1, i), random_unit(4, 2, i)).cwiseProduct(space.sizes()));
  SilentProgress progress;
  return {cup, crack::voronoi_cells(sites, space, 1, progress)};
}

/// A cube whose quarters have waves that fit into each other.
Shattered wavy_quarters() {
  constexpr double size = 0.1, h = size / 24;
  const Box space(Vec3::Constant(-size / 2), Vec3::Constant(size / 2));
  const auto wave = [](double x) { return 0.1 * size * std::sin(3 * pi * x / size); };
  const crack::DamageField field = crack::setup::cloud(space, h, crack::setup::everywhere, [&](const Vec3& x) {
    return std::min(std::abs(x.x() - wave(x.z())), std::abs(x.y() - wave(x.x()))) < 1.5 * h;
  });
  SilentProgress progress;
  return {geometry::box(space.sizes()), crack::extract(field, space, {}, progress).boundary};
}

/// D4. Fragments inherit v + w x r and w. The collision hulls of hollow faces bulge over the crack: that may not push.
Outcome birth() {
  double lost = 0, gained = 0, popped = 0, parts = 0, depth = 0;
  for (const Shattered& shattered : {shattered_cup(), wavy_quarters()}) {
    parts += static_cast<double>(shattered.parts.size());
    lost = std::max(lost, shattered.lost());
    World moving = shattered.fragments(true), still = shattered.fragments(false);
    const double energy = kinetic_energy(moving);
    constexpr double ten_steps = 10.0 / 480;
    run(moving, ten_steps);
    run(still, ten_steps);
    for (const World::Overlap& o : shattered.fragments(false, 0).overlaps()) depth = std::max(depth, o.depth);
    gained = std::max(gained, kinetic_energy(moving) / energy);
    popped = std::max(popped, fastest(still));
  }
  Outcome outcome;
  outcome.checks = {within("cup in cells, cube in wavy quarters: fragments", parts, 20, 60),
                    absolute("momentum, angular momentum, energy lost at birth [those of the body]", lost, 0, 1e-12),
                    within("deepest overlap of their collision hulls [m]", depth, 1e-4, 0.01),
                    within("energy after ten steps [at birth]", gained, 0.5, 1.01),
                    absolute("born at rest: fastest after ten steps [m/s]", popped, 0, 1e-3)};
  return outcome;
}

/// D7
Outcome stacks() {
  Outcome outcome;
  for (const double size : {0.01, 0.1, 1.0}) {
    World world(on_ground());
    std::vector<BodyId> ids;
    for (int i = 0; i < 5; ++i) ids.push_back(world.add(box(Vec3::Constant(size / 2), Vec3(0, (i + 0.5) * size, 0))));
    run(world, 10);
    double drift = 0;
    for (int i = 0; i < 5; ++i)
      drift = std::max(
          drift, (world.state(ids[static_cast<std::size_t>(i)]).pose.position - Vec3(0, (i + 0.5) * size, 0)).norm());
    char name[64];
    std::snprintf(name, sizeof name, "tower of five boxes of %g m, 10 s: drift [box]", size);
    outcome.checks.push_back(absolute(name, drift / size, 0, 0.01));
  }
  return outcome;
}

/// D8. Five balls in a row: how those that touch share a hit, Newton's law leaves open; with gaps that take more than a
/// step to close, the last one takes all.
Outcome cradle() {
  constexpr double radius = 0.02, speed = 1.5;
  Farthest momentum(1), energy(1), last(1), hit(1);
  double most = 0;
  for (const double gap : {0.0, 1e-5, 1e-3, 5e-3}) {
    World world(weightless());
    const BodyId first = world.add(bouncy_ball(radius, Vec3(-0.1, 0, 0), Vec3(speed, 0, 0)));
    for (int i = 0; i < 4; ++i) world.add(bouncy_ball(radius, Vec3(i * (2 * radius + gap), 0, 0), Vec3::Zero()));
    const double before = kinetic_energy(world), thrown = world.mass(first) * speed;
    double impulse = 0;
    for (int i = 0; i < 240; ++i) {
      std::map<std::pair<BodyId, BodyId>, int> impacts;
      for (const Impact& impact : world.step()) {
        most = std::max(most, static_cast<double>(++impacts[{impact.body_a, impact.body_b}]));
        if (impact.body_a == first || impact.body_b == first) impulse += impact.impulse;
      }
    }
    Vec3 total = Vec3::Zero();
    for (const BodyId id : world.bodies()) total += world.mass(id) * world.state(id).twist.linear;
    momentum.take(total.x() / thrown);
    energy.take(kinetic_energy(world) / before);
    if (gap < speed / 480) continue;
    last.take(world.state(world.bodies().back()).twist.linear.x() / speed);
    hit.take(impulse / thrown);
  }
  Outcome outcome;
  outcome.checks = {absolute("gaps of 0 to 5 mm: momentum [that of the first]", momentum.value(), 1, 0.02),
                    absolute("gaps of 0 to 5 mm: energy [that of the first]", energy.value(), 1, 0.02),
                    absolute("most impacts of a pair in a step", most, 1, 0),
                    absolute("gap of 5 mm: speed of the last [that of the first]", last.value(), 1, 0.02),
                    absolute("gap of 5 mm: impulse of the first [its momentum]", hit.value(), 1, 0.02)};
  return outcome;
}

}  // namespace

std::vector<Problem> rigid_bodies() {
  return {
      {"D1", "Free flight and free tops", "parabola; Euler's equations", free_flight,
       Study{"place of a thrown body after a second [m]", "steps in a second", {120, 240, 480}, 0.99, parabola_study}},
      {"D2", "Mass properties of meshes", "closed forms", mass_properties,
       Study{"volume of a sphere's mesh [sphere]",
             "edges along an icosahedron's edge",
             {4, 8, 16},
             1.9,
             sphere_volume_error}},
      {"D3", "Bouncing, sliding, sticking", "Newton's law of impact; Coulomb", restitution_and_friction},
      {"D4b", "Birth of fragments: a rigid field, and no push by overlaps", "conservation", birth},
      {"D5", "Determinism of a heap", "identity", determinism},
      {"D7", "Towers of boxes", "rest", stacks},
      {"D8", "Newton's cradle", "conservation", cradle}};
}

}  // namespace sunder::validation
