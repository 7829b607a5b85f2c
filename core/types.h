#pragma once
/// The few types that every module shares. SI units everywhere.
#include <algorithm>
#include <cstdint>
#include <limits>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace sunder {

using Vec3 = Eigen::Vector3d;
using Mat3 = Eigen::Matrix3d;
using Quat = Eigen::Quaterniond;

/// Axis-aligned box [m]; empty until something is added.
using Box = Eigen::AlignedBox3d;

/// Where a rigid body's frame sits in the world: x_world = position + orientation * x_body.
struct Pose {
  Vec3 position = Vec3::Zero();
  Quat orientation = Quat::Identity();

  Vec3 operator*(const Vec3& x) const { return position + orientation * x; }
  Vec3 inverse(const Vec3& x) const { return orientation.conjugate() * (x - position); }
};

/// Rigid motion: velocity of the centre of mass [m/s] and angular velocity in world axes [rad/s].
struct Twist {
  Vec3 linear = Vec3::Zero();
  Vec3 angular = Vec3::Zero();

  /// Velocity of the point at offset `r` (world axes) from the centre of mass.
  Vec3 at(const Vec3& r) const { return linear + angular.cross(r); }
};

}  // namespace sunder
