#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Geometry>

#include "geometry/mass_properties.h"
#include "geometry/primitives.h"
#include "validation/catalogue.h"
#include "validation/detail/parts.h"
#include "validation/moving_bodies.h"

namespace sunder::validation {
namespace {

using namespace rigid;
using namespace rigid::setup;
using std::numbers::pi;

constexpr double gravity = 9.81;

/// Where a thrown body is after a second, over the error of symplectic Euler, g t dt / 2.
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
      absolute("free top for 10 s: drift of the energy [1]", top.energy_drift, 0, 1e-3),
      absolute("free top: drift of the angular momentum [1]", top.momentum_drift, 0, 1e-3),
      relative("about the middle axis: time between flips [Euler's equations]",
               flips ? flipping.flips[1] - flipping.flips[0] : 0, flips ? expected[1] - expected[0] : 1, 0.02)};
  return outcome;
}

/// Relative errors of a polyhedron's volume and moment of inertia about y.
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
  const double volume = 2 * pi * pi * ring * tube * tube;
  const MassError torus =
      mass_error(geometry::torus(ring, tube, 384, 128), volume, volume * (ring * ring + 0.75 * tube * tube));
  Outcome outcome;
  outcome.checks = {
      absolute("box: volume [exact]", block.volume, 0, 1e-12),
      absolute("box: moment of inertia [exact]", block.inertia, 0, 1e-12),
      absolute("box: centre of mass [m]", block.centre, 0, 1e-12),
      within("sphere: order of the volume in the edge length", std::log2(coarse.volume / fine.volume), 1.9, 2.1),
      within("sphere: order of the moment of inertia", std::log2(coarse.inertia / fine.inertia), 1.9, 2.1),
      absolute("torus of 384 x 128: volume [exact]", torus.volume, 0, 1e-3),
      absolute("torus: moment of inertia [exact]", torus.inertia, 0, 1e-3)};
  return outcome;
}

StudyPoint sphere_volume_error(int faces_along) {
  // Each subdivision halves the edges.
  return {sphere_error(static_cast<int>(std::lround(std::log2(faces_along)))).volume, 0};
}

/// Height of the first bounce over that of the fall; and when the ball comes to rest [s].
struct Bounce {
  double height = 0, end = 0;
};
Bounce bounce(double restitution, double drop) {
  constexpr double radius = 0.05;
  World world(on_ground(restitution));
  BodySetup setup = ball(radius, Vec3(0, radius + drop, 0));
  setup.restitution = 1;
  const BodyId id = world.add(setup);
  Bounce result;
  bool fell = false;
  while (world.time() < 4) {
    world.step();
    const BodyState s = world.state(id);
    if (s.twist.linear.y() > 0) fell = true;
    if (fell && result.end < 1) result.height = std::max(result.height, (s.pose.position.y() - radius) / drop);
    if (std::abs(s.twist.linear.y()) > 0.05) result.end = world.time();
    if (fell && s.twist.linear.y() < 0 && result.height > 0 && restitution == 0) break;
  }
  return result;
}

/// Acceleration down a slope; gravity is tilted instead of the ground [m/s^2].
double slide(double angle, double friction) {
  WorldSettings settings = on_ground(0, friction);
  settings.gravity = gravity * Vec3(std::sin(angle), -std::cos(angle), 0);
  World world(settings);
  BodySetup setup = box(Vec3(0.1, 0.025, 0.1), Vec3(0, 0.025, 0));
  setup.friction = friction;
  const BodyId id = world.add(setup);
  run(world, 0.5);
  return world.state(id).twist.linear.x() / 0.5;
}

/// D3
Outcome restitution_and_friction() {
  constexpr double e = 0.5, drop = 1, angle = 0.6, mu = 0.4;
  const Bounce elastic = bounce(e, drop), plastic = bounce(0, drop);
  Outcome outcome;
  outcome.checks = {relative("e = 0.5: height of the first bounce [fall]", elastic.height, e * e, 0.05),
                    relative("e = 0.5: all bounces together last [s]", elastic.end,
                             std::sqrt(2 * drop / gravity) * (1 + e) / (1 - e), 0.05),
                    absolute("e = 0: height of a bounce [fall]", plastic.height, 0, 1e-3),
                    relative("slope of 0.6 rad, mu = 0.4: acceleration [m/s^2]", slide(angle, mu),
                             gravity * (std::sin(angle) - mu * std::cos(angle)), 0.03),
                    absolute("slope of 0.3 rad: acceleration [m/s^2]", slide(0.3, mu), 0, 1e-3)};
  return outcome;
}

World heap() {
  World world(on_ground());
  for (std::uint64_t i = 0; i < 30; ++i) {
    const auto unit = [&](std::uint64_t k) { return random_unit(11, k, i); };
    BodySetup setup = box(Vec3(0.02 + 0.03 * unit(0), 0.02 + 0.03 * unit(1), 0.02 + 0.03 * unit(2)),
                          Vec3(0.1 * unit(3), 0.1 + 0.11 * static_cast<double>(i), 0.1 * unit(4)));
    setup.pose.orientation = random_turn(5, i);
    setup.twist.linear = Vec3(unit(5), -2 * unit(6), unit(7));
    world.add(setup);
  }
  return world;
}

/// D5. Promised for one build on one kind of machine, for any number of threads.
Outcome determinism() {
  World first = heap(), second = heap();
  double differing = 0, after_restore = 0;
  for (int i = 0; i < 480; ++i) {
    first.step();
    second.step();
    differing += hash(first) != hash(second);
  }
  const World::Snapshot half = first.snapshot();
  run(first, 1);
  const std::uint64_t end = hash(first);
  first.restore(half);
  run(first, 1);
  after_restore += hash(first) != end;
  Outcome outcome;
  outcome.checks = {absolute("30 bodies, two runs: steps after which they differ", differing, 0, 0),
                    absolute("restored and run again: states that differ", after_restore, 0, 0)};
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

/// D8. Five balls in a row; what arrives at the first contact is what the last one takes.
Outcome cradle() {
  constexpr double radius = 0.02, speed = 1.5;
  Outcome outcome;
  for (const double gap : {0.0, 1e-3}) {
    World world(weightless());
    const auto bouncy = [&](double x, double v) {
      BodySetup setup = ball(radius, Vec3(x, 0, 0));
      setup.restitution = 1;
      setup.friction = 0;
      setup.twist.linear = Vec3(v, 0, 0);
      return world.add(setup);
    };
    const BodyId first = bouncy(-0.1, speed);
    for (int i = 0; i < 4; ++i) bouncy(i * (2 * radius + gap), 0);
    const double energy = kinetic_energy(world), momentum = world.mass(first) * speed;
    double hit = 0, impulse = 0;
    for (const Impact& impact : run(world, 0.5))
      if (impact.body_a == first || impact.body_b == first) hit += 1, impulse += impact.impulse;
    Vec3 total = Vec3::Zero();
    for (const BodyId id : world.bodies()) total += world.mass(id) * world.state(id).twist.linear;
    const std::string name = gap > 0 ? "gaps of 1 mm: " : "touching: ";
    outcome.checks.push_back(absolute(name + "momentum [that of the first]", total.x() / momentum, 1, 0.02));
    outcome.checks.push_back(absolute(name + "energy [that of the first]", kinetic_energy(world) / energy, 1, 0.02));
    outcome.checks.push_back(within(name + "contacts of the first ball", hit, 1, 3));
    // How balls that touch share a hit, Newton's law leaves open.
    if (gap > 0)
      outcome.checks.push_back(absolute(name + "their impulse [momentum of the first]", impulse / momentum, 1, 0.02));
  }
  return outcome;
}

}  // namespace

std::vector<Problem> rigid_bodies() {
  return {{"D1", "Free flight and free tops", "parabola; Euler's equations", free_flight},
          {"D2", "Mass properties of meshes", "closed forms", mass_properties,
           Study{"volume of a sphere's mesh [sphere]",
                 "edges along an icosahedron's edge",
                 {4, 8, 16},
                 1.9,
                 sphere_volume_error}},
          {"D3", "Bouncing, sliding, sticking", "Newton's law of impact; Coulomb", restitution_and_friction},
          {"D5", "Determinism of a heap", "identity", determinism},
          {"D7", "Towers of boxes", "rest", stacks},
          {"D8", "Newton's cradle", "conservation", cradle}};
}

}  // namespace sunder::validation
