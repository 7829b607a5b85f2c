#include "output/detail/light.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace sunder::output::detail {
namespace {

constexpr float kPi = std::numbers::pi_v<float>;
const Rgb kZenith(0.50f, 0.60f, 0.78f), kHorizon(0.84f, 0.86f, 0.88f);
const Rgb kBoxRadiance(2.6f, 2.5f, 2.35f);
constexpr float kExposure = 0.50f;

Rgb mixed(const Rgb& a, const Rgb& b, float share) { return a + share * (b - a); }

float srgb(float x) { return x <= 0.0031308f ? 12.92f * x : 1.055f * std::pow(x, 1 / 2.4f) - 0.055f; }

/// Sun on the right (1) or on the left (-1).
Light light_from(const Camera& camera, double side) {
  const Vec3 right = side * camera.axes.col(0), back = camera.axes.col(2);
  const Vec3 level = Vec3(back.x(), 0, back.z()).normalized();
  Light light;
  light.sun = (0.75 * right + 1.0 * Vec3::UnitY() + 0.25 * level).normalized().cast<float>();
  light.box = (-0.9 * right + 0.55 * Vec3::UnitY() - 0.35 * level).normalized().cast<float>();
  return light;
}

/// Number of the points that light from a direction gets to.
std::ptrdiff_t reached(const RayScene& scene, std::span<const Vec3> points, const Vec3f& sun) {
  constexpr float kLift = 1e-3f;  // in sizes of the subject
  std::vector<Ray> rays;
  for (const Vec3& point : points) rays.push_back({point.cast<float>() + kLift * sun, sun});
  std::vector<std::uint8_t> blocked(rays.size());
  scene.blocked(rays, RayScene::Kind::opaque, blocked);
  return std::count(blocked.begin(), blocked.end(), 0);
}

}  // namespace

Rgb Light::sky(const Vec3f& direction) const {
  const Rgb above = mixed(kHorizon, kZenith, std::sqrt(std::clamp(direction.y(), 0.0f, 1.0f)));
  if (direction.y() < 0) {
    const Rgb below = has_floor ? Rgb(floor_colour * (0.6f * sunlight * sun.y() + 0.7f * ambient(Vec3f::UnitY())))
                                : Rgb(0.6f * kHorizon);
    return mixed(above, below, smooth_step(0, 0.15f, -direction.y()));
  }
  return above;
}

Rgb Light::reflected(const Vec3f& direction) const {
  constexpr float kEdge = 0.90f, kInner = 0.95f;  // cosines of the soft box's half angles
  return sky(direction) + kBoxRadiance * smooth_step(kEdge, kInner, direction.dot(box));
}

Rgb Light::ambient(const Vec3f& normal) const {
  const Rgb below = (has_floor ? 0.35f : 0.6f) * kHorizon;
  return mixed(below, mixed(kHorizon, kZenith, 0.6f), 0.5f + 0.5f * normal.y());
}

Rgb Light::backdrop(const Vec3f& direction) const {
  const Rgb low(0.50f, 0.52f, 0.55f), high(0.20f, 0.23f, 0.28f);
  return mixed(low, high, smooth_step(-0.55f, 0.1f, direction.y()));
}

Light light_for(const Camera& camera, const RayScene& scene, std::span<const Vec3> samples, bool has_floor) {
  constexpr double kClearlyMore = 1.2;
  Light left = light_from(camera, -1), right = light_from(camera, 1);
  left.has_floor = right.has_floor = has_floor;
  const auto by_left = static_cast<double>(reached(scene, samples, left.sun));
  return static_cast<double>(reached(scene, samples, right.sun)) > kClearlyMore * by_left ? right : left;
}

Rgb fresnel(const Rgb& straight, float cosine) {
  const float away = 1 - std::clamp(cosine, 0.0f, 1.0f);
  const float square = away * away;
  return straight + (1 - straight) * (square * square * away);
}

Rgb glossy(const Rgb& straight, float roughness, const Vec3f& normal, const Vec3f& to_eye, const Vec3f& to_light) {
  const float facing = normal.dot(to_light);
  const Vec3f half = (to_eye + to_light).normalized();
  if (facing <= 0 || normal.dot(to_eye) <= 0) return Rgb::Zero();
  const float alpha = std::max(roughness * roughness, 0.02f), square = alpha * alpha;
  const float cosine = normal.dot(half), bend = cosine * cosine * (square - 1) + 1;
  const float distribution = square / (kPi * bend * bend);
  const float along = std::max(to_light.dot(half), 1e-3f);
  return fresnel(straight, along) * (kPi * distribution * facing / (4 * along * along));
}

std::array<std::uint8_t, 3> developed(const Rgb& radiance) {
  const Rgb x = kExposure * radiance.max(0);
  const Rgb film = (x * (2.51f * x + 0.03f) / (x * (2.43f * x + 0.59f) + 0.14f)).min(1);
  std::array<std::uint8_t, 3> bytes;
  for (int i = 0; i < 3; ++i)
    bytes[static_cast<std::size_t>(i)] = static_cast<std::uint8_t>(std::lround(255 * srgb(film[i])));
  return bytes;
}

}  // namespace sunder::output::detail
