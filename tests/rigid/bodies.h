#pragma once
/// Bodies with closed-form mass properties for the tests of `rigid`.
#include <cmath>
#include <cstring>
#include <numbers>
#include <vector>

#include "core/random.h"
#include "rigid/world.h"

namespace sunder::rigid::test {

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
