#include "output/detail/camera.h"

#include <cassert>
#include <cmath>

namespace sunder::output::detail {

Vec3 Camera::direction(const Eigen::Vector2d& picture) const {
  return (axes * Vec3(picture.x() * half.x(), picture.y() * half.y(), -1)).normalized();
}

Eigen::Vector2d Camera::project(const Vec3& point) const {
  const Vec3 local = axes.transpose() * (point - eye);
  return (local.head<2>() / -local.z()).cwiseQuotient(half);
}

Vec3 backward(double azimuth, double elevation) {
  return {std::sin(azimuth) * std::cos(elevation), std::sin(elevation), std::cos(azimuth) * std::cos(elevation)};
}

Camera fitted_camera(std::span<const Vec3> points, const Vec3& backward, const Eigen::Vector2d& half, double fill) {
  assert(!points.empty());
  Camera camera;
  camera.half = half;
  const Vec3 right = Vec3::UnitY().cross(backward).normalized();
  camera.axes << right, backward.cross(right), backward;
  // A point at x and depth z lies between the planes of the field of view when |x - eye.x| <= t (eye.z - z).
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const Eigen::Array2d t = fill * half.array();
  Eigen::Array2d upper = Eigen::Array2d::Constant(-kInfinity), lower = upper;
  double nearest = -kInfinity;
  for (const Vec3& point : points) {
    const Vec3 x = camera.axes.transpose() * point;
    upper = upper.max(x.head<2>().array() + t * x.z());
    lower = lower.max(t * x.z() - x.head<2>().array());
    nearest = std::max(nearest, x.z());
  }
  Vec3 eye;
  eye.head<2>() = (upper - lower) / 2;
  eye.z() = std::max(((upper + lower) / (2 * t)).maxCoeff(), nearest);
  camera.eye = camera.axes * eye;
  return camera;
}

}  // namespace sunder::output::detail
