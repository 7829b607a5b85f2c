#include "output/detail/viewpoint.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Eigenvalues>

namespace sunder::output::detail {
namespace {

constexpr double kDegree = std::numbers::pi / 180;
constexpr double kHalfHeight = 0.2;  // tangent of half the vertical angle of view: a long lens, little distortion
constexpr double kClearlyBetter = 1.1;
constexpr double kLongSide = 1.5;  // standard deviation along over that across, from which a subject has a long side
constexpr std::array<double, 4> kAzimuths = {32, -32, 148, -148};
constexpr double kLow = 16, kHigh = 36;  // elevation of the camera above what is tall, and above what lies flat

double elevation(std::span<const Vec3> points) {
  Box box;
  for (const Vec3& point : points) box.extend(point);
  const Vec3 size = box.sizes();
  const double upright = size.y() / std::max({size.x(), size.z(), 1e-9});
  return kDegree * (kHigh + (kLow - kHigh) * std::min(upright, 1.0));
}

/// Azimuth of the horizontal normal of the subject's long side, on the side of +Z (or of +X); 0 without one.
double front(std::span<const Vec3> samples) {
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  Eigen::Matrix2d moment = Eigen::Matrix2d::Zero();
  for (const Vec3& sample : samples) {
    const Eigen::Vector2d level(sample.x(), sample.z());
    mean += level / static_cast<double>(samples.size());
    moment += level * level.transpose() / static_cast<double>(samples.size());
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> axes(moment - mean * mean.transpose());
  if (axes.eigenvalues()[1] <= kLongSide * kLongSide * axes.eigenvalues()[0]) return 0;
  Eigen::Vector2d normal = axes.eigenvectors().col(0);
  if (normal.y() < -1e-6 || (std::abs(normal.y()) <= 1e-6 && normal.x() < 0)) normal = -normal;
  return std::atan2(normal.x(), normal.y());
}

/// Share of the points that nothing hides.
double visible_share(const RayScene& scene, const Vec3& eye, std::span<const Vec3> points) {
  constexpr double kShort = 1e-3;  // of the subject's size, short of the surface that the point is on
  std::vector<Ray> rays;
  for (const Vec3& point : points) {
    const Vec3 way = point - eye;
    rays.push_back({eye.cast<float>(), way.normalized().cast<float>(), static_cast<float>(way.norm() - kShort)});
  }
  std::vector<std::uint8_t> opaque(rays.size()), clear(rays.size());
  scene.blocked(rays, RayScene::Kind::opaque, opaque);
  scene.blocked(rays, RayScene::Kind::clear, clear);
  std::size_t hidden = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) hidden += opaque[i] || clear[i] ? 1 : 0;
  return 1 - static_cast<double>(hidden) / static_cast<double>(rays.size());
}

}  // namespace

Camera viewpoint(const RayScene& scene, std::span<const Vec3> points, std::span<const Vec3> samples, double aspect,
                 double fill) {
  Vec3 centre = Vec3::Zero();
  for (const Vec3& sample : samples) centre += sample / static_cast<double>(samples.size());
  const double facing = front(samples);
  Camera best;
  double best_score = -1;
  for (const double azimuth : kAzimuths) {
    const Camera camera = fitted_camera(points, backward(facing + azimuth * kDegree, elevation(points)),
                                        {kHalfHeight * aspect, kHalfHeight}, fill);
    const double distance = (camera.eye - centre).norm();
    const double score = visible_share(scene, camera.eye, samples) / (distance * distance);
    if (score > kClearlyBetter * best_score) {
      best_score = score;
      best = camera;
    }
  }
  return best;
}

}  // namespace sunder::output::detail
