#pragma once
/// Bodies with closed-form mass properties, and worlds for them: set-ups of the catalogue and of the tests of `rigid`.
#include <cmath>
#include <cstring>
#include <numbers>
#include <vector>

#include "core/random.h"
#include "rigid/world.h"

namespace sunder::rigid::setup {

/// Corners alone: collision hulls need no faces.
inline geometry::TriangleMesh corners_of_box(const Vec3& half, const Vec3& centre = Vec3::Zero()) {
  geometry::TriangleMesh mesh;
  for (int i = 0; i < 8; ++i)
    mesh.vertices.push_back(centre + half.cwiseProduct(Vec3(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1)));
  return mesh;
}

inline Mat3 box_inertia(double mass, const Vec3& half) {
  const Vec3 square = half.cwiseProduct(half);
  return (mass / 3 * Vec3(square.y() + square.z(), square.z() + square.x(), square.x() + square.y())).asDiagonal();
}

inline BodySetup box(const Vec3& half, const Vec3& position, double density = 1000) {
  BodySetup setup;
  setup.hulls = {corners_of_box(half)};
  setup.mass = density * 8 * half.prod();
  setup.inertia = box_inertia(setup.mass, half);
  setup.pose.position = position;
  return setup;
}

/// Rings of points on a sphere: flat to 1 - cos(pi / 2 / rings) of the radius, with points exactly on all three axes.
inline geometry::TriangleMesh points_of_ball(double radius, int rings = 8) {
  geometry::TriangleMesh mesh;
  mesh.vertices = {Vec3(0, radius, 0), Vec3(0, -radius, 0)};
  for (int i = 1; i < rings; ++i) {
    const double polar = std::numbers::pi * i / rings;
    for (int k = 0; k < 2 * rings; ++k) {
      const double turn = std::numbers::pi * k / rings;
      mesh.vertices.push_back(
          radius * Vec3(std::sin(polar) * std::cos(turn), std::cos(polar), std::sin(polar) * std::sin(turn)));
    }
  }
  return mesh;
}

inline BodySetup ball(double radius, const Vec3& position, double density = 1000, int rings = 8) {
  BodySetup setup;
  setup.hulls = {points_of_ball(radius, rings)};
  setup.mass = density * 4 / 3 * std::numbers::pi * std::pow(radius, 3);
  setup.inertia = 0.4 * setup.mass * radius * radius * Mat3::Identity();
  setup.pose.position = position;
  return setup;
}

/// Regular tetrahedron with one face down; its centre of mass lies a third of the circumradius above that face.
inline BodySetup tetrahedron(double circumradius, const Vec3& position, double density = 1000) {
  BodySetup setup;
  geometry::TriangleMesh mesh;
  mesh.vertices = {Vec3(0, circumradius, 0)};
  const double ring = circumradius * std::sqrt(8.0) / 3;
  for (int k = 0; k < 3; ++k) {
    const double turn = 2 * std::numbers::pi * k / 3;
    mesh.vertices.push_back({ring * std::cos(turn), -circumradius / 3, ring * std::sin(turn)});
  }
  const double edge = circumradius * std::sqrt(8.0 / 3);
  setup.hulls = {mesh};
  setup.mass = density * std::pow(edge, 3) / (6 * std::sqrt(2.0));
  setup.inertia = setup.mass * edge * edge / 20 * Mat3::Identity();
  setup.pose.position = position;
  return setup;
}

/// Loses nothing when it hits its like.
inline BodySetup bouncy_ball(double radius, const Vec3& position, const Vec3& velocity) {
  BodySetup setup = ball(radius, position);
  setup.restitution = 1;
  setup.friction = 0;
  setup.twist.linear = velocity;
  return setup;
}

inline WorldSettings on_ground(double restitution = 0.3, double friction = 0.6) {
  WorldSettings settings;
  settings.has_ground = true;
  settings.ground_restitution = restitution;
  settings.ground_friction = friction;
  return settings;
}

inline WorldSettings weightless() {
  WorldSettings settings;
  settings.gravity.setZero();
  return settings;
}

inline std::vector<Impact> run(World& world, double seconds, double time_step = 1.0 / 480) {
  std::vector<Impact> all;
  for (int i = 0; i < std::lround(seconds / time_step); ++i)
    for (const Impact& impact : world.step()) all.push_back(impact);
  return all;
}

inline double kinetic_energy(const World& world, BodyId id) {
  const Twist twist = world.state(id).twist;
  return (world.mass(id) * twist.linear.squaredNorm() + twist.angular.dot(world.world_inertia(id) * twist.angular)) / 2;
}

inline double kinetic_energy(const World& world) {
  double sum = 0;
  for (BodyId id : world.bodies()) sum += kinetic_energy(world, id);
  return sum;
}

inline double fastest(const World& world) {
  double speed = 0;
  for (BodyId id : world.bodies()) speed = std::max(speed, world.state(id).twist.linear.norm());
  return speed;
}

/// FNV-1a over the bits of all states.
inline std::uint64_t hash(const World& world) {
  std::uint64_t h = 14695981039346656037ULL;
  const auto take = [&](double x) {
    std::uint64_t bits;
    std::memcpy(&bits, &x, sizeof bits);
    for (int i = 0; i < 8; ++i) h = (h ^ (bits >> (8 * i) & 255)) * 1099511628211ULL;
  };
  for (BodyId id : world.bodies()) {
    const BodyState s = world.state(id);
    for (int i = 0; i < 3; ++i) take(s.pose.position[i]), take(s.twist.linear[i]), take(s.twist.angular[i]);
    for (int i = 0; i < 4; ++i) take(s.pose.orientation.coeffs()[i]);
  }
  return h;
}

inline Quat random_turn(std::uint64_t stream, std::uint64_t index) {
  const auto unit = [&](int k) { return random_unit(7, stream, 4 * index + static_cast<std::uint64_t>(k)); };
  const double a = 2 * std::numbers::pi * unit(0), b = 2 * std::numbers::pi * unit(1), u = unit(2);
  return Quat(std::sqrt(u) * std::cos(b), std::sqrt(1 - u) * std::sin(a), std::sqrt(1 - u) * std::cos(a),
              std::sqrt(u) * std::sin(b));
}

/// Boxes that fall on a heap.
inline World pile(int count) {
  World world(on_ground());
  for (int i = 0; i < count; ++i) {
    const auto unit = [&](std::uint64_t k) { return random_unit(11, k, static_cast<std::uint64_t>(i)); };
    BodySetup setup = box(Vec3(0.02 + 0.03 * unit(0), 0.02 + 0.03 * unit(1), 0.02 + 0.03 * unit(2)),
                          Vec3(0.1 * unit(3), 0.1 + 0.11 * i, 0.1 * unit(4)));
    setup.pose.orientation = random_turn(5, static_cast<std::uint64_t>(i));
    setup.twist.linear = Vec3(unit(5), -2 * unit(6), unit(7));
    world.add(setup);
  }
  return world;
}

}  // namespace sunder::rigid::setup
