#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/random.h"
#include "output/detail/samples.h"

namespace sunder::output::detail {
namespace {

constexpr float kPi = std::numbers::pi_v<float>;
constexpr std::uint64_t kSeed = 0x706f73746572;
constexpr float kClearShade = 0.45f;       // of the light that a clear body takes from what lies behind it
constexpr float kInterreflection = 0.12f;  // of the light that a blocked sky would give, from what blocks it
constexpr float kSunRadius = 0.045f;       // tangent of the half angle, wide for soft shadows
constexpr float kDark = 0.02f;             // colour from which reflections are as bright as they should be
constexpr float kGlossy = 0.6f;            // roughness from which reflections are not followed
constexpr float kLift = 2e-4f;             // off a surface, for rays that start on it, in sizes of the subject

/// Duff et al., "Building an orthonormal basis, revisited" (2017).
Vec3f turned(const Vec3f& normal, float x, float y, float z) {
  const float sign = std::copysign(1.0f, normal.z());
  const float a = -1 / (sign + normal.z()), b = normal.x() * normal.y() * a;
  return x * Vec3f(1 + sign * normal.x() * normal.x() * a, sign * b, -sign * normal.x()) +
         y * Vec3f(b, sign + normal.y() * normal.y() * a, -normal.y()) + z * normal;
}

Vec3f cosine_weighted(const Vec3f& normal, std::pair<float, float> random) {
  const float radius = std::sqrt(random.first), angle = 2 * kPi * random.second;
  return turned(normal, radius * std::cos(angle), radius * std::sin(angle),
                std::sqrt(std::max(0.0f, 1 - random.first)));
}

/// From the surfaces to the lights.
class Lighting {
 public:
  Lighting(const View& view, std::span<Sample> samples) : view_(view), samples_(samples) {}

  void sun() {
    std::vector<Ray> rays;
    std::vector<Sample*> lit;
    for (Sample& sample : samples_) {
      if (!sample.lit) continue;
      const auto [a, b] = sample.random.pair(RandomPairs::sun);
      const float radius = kSunRadius * std::sqrt(a), angle = 2 * kPi * b;
      const Vec3f sun = turned(view_.light.sun, radius * std::cos(angle), radius * std::sin(angle), 1).normalized();
      if (sample.normal.dot(sun) <= 0 || sample.outward.dot(sun) <= 0) continue;
      rays.push_back({start(sample), sun});
      lit.push_back(&sample);
    }
    const std::vector<float> shares = arriving(rays);
    for (std::size_t i = 0; i < rays.size(); ++i) {
      Sample& sample = *lit[i];
      const Rgb light = shares[i] * view_.light.sunlight;
      const Rgb glint = glossy(sample.straight, sample.roughness, sample.normal, -sample.direction, view_.light.sun);
      sample.own += sample.through * glint * light;
      if (!is_metal(sample)) sample.light += sample.normal.dot(rays[i].direction) * light;
    }
  }

  void sky() {
    std::vector<Ray> rays;
    std::vector<Sample*> lit;
    for (Sample& sample : samples_) {
      if (!sample.lit || is_metal(sample)) continue;
      rays.push_back({start(sample), cosine_weighted(sample.normal, sample.random.pair(RandomPairs::sky))});
      lit.push_back(&sample);
    }
    const std::vector<float> shares = arriving(rays);
    for (std::size_t i = 0; i < rays.size(); ++i) {
      Sample& sample = *lit[i];
      const float share = rays[i].direction.dot(sample.outward) > 0 ? shares[i] : 0;
      sample.light += share * view_.light.sky(rays[i].direction) +
                      (1 - share) * kInterreflection * view_.light.ambient(sample.normal);
    }
  }

  void reflect() {
    std::vector<Ray> rays;
    std::vector<Sample*> lit;
    for (Sample& sample : samples_) {
      if (!sample.lit || (sample.roughness > kGlossy && !is_metal(sample))) continue;
      const auto [a, b] = sample.random.pair(RandomPairs::mirror);
      const float radius = sample.roughness * sample.roughness * std::sqrt(a), angle = 2 * kPi * b;
      const Vec3f mirror =
          turned(mirrored(sample.direction, sample.normal), radius * std::cos(angle), radius * std::sin(angle), 1)
              .normalized();
      rays.push_back({start(sample), mirror});
      lit.push_back(&sample);
    }
    const std::vector<float> shares = arriving(rays);
    for (std::size_t i = 0; i < rays.size(); ++i) {
      Sample& sample = *lit[i];
      const float share = rays[i].direction.dot(sample.outward) > 0 ? shares[i] : 0;
      const Rgb seen = share * view_.light.reflected(rays[i].direction) + (1 - share) * kInterreflection;
      // As part of the light, so that it is smoothed with it.
      const Rgb share_of_colour = is_metal(sample)
                                      ? Rgb::Ones()
                                      : Rgb(fresnel(sample.straight, -sample.normal.dot(sample.direction)) *
                                            sample.through / sample.colour.max(kDark));
      sample.light += share_of_colour * seen;
    }
  }

 private:
  Vec3f start(const Sample& sample) const { return sample.point + kLift * sample.outward; }

  /// Shares of light that come through along the rays.
  std::vector<float> arriving(const std::vector<Ray>& rays) const {
    std::vector<std::uint8_t> opaque(rays.size()), clear(rays.size(), 0);
    view_.rays.blocked(rays, RayScene::Kind::opaque, opaque);
    if (view_.rays.has(RayScene::Kind::clear)) view_.rays.blocked(rays, RayScene::Kind::clear, clear);
    std::vector<float> shares(rays.size());
    for (std::size_t i = 0; i < rays.size(); ++i) shares[i] = opaque[i] ? 0 : clear[i] ? 1 - kClearShade : 1;
    return shares;
  }

  static bool is_metal(const Sample& sample) { return (sample.straight > 0.1f).any(); }

  const View& view_;
  std::span<Sample> samples_;
};

}  // namespace

std::pair<float, float> SampleRandom::pair(RandomPairs purpose) const {
  const auto stream = static_cast<std::uint64_t>(purpose);
  const double a = random_unit(kSeed, 2 * stream, pixel) + index * 0.7548776662466927;
  const double b = random_unit(kSeed, 2 * stream + 1, pixel) + index * 0.5698402909980532;
  return {std::min(static_cast<float>(a - std::floor(a)), 0x1.fffffep-1f),
          std::min(static_cast<float>(b - std::floor(b)), 0x1.fffffep-1f)};
}

void illuminate(const View& view, std::span<Sample> samples) {
  Lighting lighting(view, samples);
  lighting.sun();
  lighting.sky();
  lighting.reflect();
}

}  // namespace sunder::output::detail
