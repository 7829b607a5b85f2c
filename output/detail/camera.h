#pragma once
/// A perspective camera.
#include <span>

#include "core/types.h"

namespace sunder::output::detail {

/// Looks along -backward. Picture coordinates: (-1, -1) is the lower left corner, (1, 1) the upper right.
struct Camera {
  Vec3 eye = Vec3(0, 0, 1);
  Mat3 axes = Mat3::Identity();                    ///< columns: right, up, backward; unit length
  Eigen::Vector2d half = Eigen::Vector2d::Ones();  ///< tangents of half the angles of view, across and up

  /// Of the ray through a point of the picture, unit length.
  Vec3 direction(const Eigen::Vector2d& picture) const;

  /// Picture coordinates of a point in front of the camera.
  Eigen::Vector2d project(const Vec3& point) const;
};

/// Towards a camera at an azimuth (from +Z towards +X) and an elevation [rad].
Vec3 backward(double azimuth, double elevation);

/// The camera closest to the points that looks against `backward` and sees them all within |x|, |y| <= fill, centred
/// in the direction that decides. `points` must not be empty; `backward` must not be vertical.
Camera fitted_camera(std::span<const Vec3> points, const Vec3& backward, const Eigen::Vector2d& half, double fill);

}  // namespace sunder::output::detail
