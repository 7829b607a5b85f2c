#include "output/detail/samples.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/random.h"

namespace sunder::output::detail {
namespace {

constexpr float kPi = std::numbers::pi_v<float>;
constexpr std::uint64_t kSeed = 0x706f73746572;
constexpr int kLayers = 12;           // of clear surfaces that a ray goes through
constexpr float kDielectric = 0.04f;  // reflectance of all that is no metal
constexpr float kTintDepth =
    0.6f;                        // of clear material that light must pass to take its colour, in sizes of the subject
constexpr float kFaint = 0.08f;  // share of light from behind that is not worth following
constexpr float kCrackHaze = 0.22f, kSkinHaze = 0.03f;  // share of light that clear surfaces scatter like paper
constexpr float kClearShade = 0.45f;                    // of the light that a clear body takes from what lies behind it
constexpr float kInterreflection = 0.12f;  // of the light that a blocked sky would give, from what blocks it
constexpr float kSunRadius = 0.045f;       // tangent of the half angle, wide for soft shadows
constexpr float kFloorFadesFrom = 2.5f, kFloorFadesTo = 11;  // distance from the subject in its sizes
constexpr float kGlossy = 0.6f;                              // roughness from which reflections are not followed

float smooth_step(float from, float to, float x) {
  const float t = std::clamp((x - from) / (to - from), 0.0f, 1.0f);
  return t * t * (3 - 2 * t);
}

Vec3f mirrored(const Vec3f& direction, const Vec3f& normal) { return direction - 2 * direction.dot(normal) * normal; }

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

template <class List>
const auto& at(const List& list, const Hit& hit) {
  return list[static_cast<std::size_t>(hit.triangle)];
}

template <class Corners>
auto blend(const Corners& corners, const Hit& hit) {
  return ((1 - hit.u - hit.v) * corners[0] + hit.u * corners[1] + hit.v * corners[2]).eval();
}

class Shader {
 public:
  Shader(const View& view, std::span<Sample> samples) : view_(view), samples_(samples) {}

  void shade() {
    follow();
    light_by_sun();
    light_by_sky();
    reflect();
  }

 private:
  // -- Up to the opaque surface --

  void follow() {
    std::vector<std::size_t> active(samples_.size());
    std::vector<Ray> rays;
    for (std::size_t i = 0; i < samples_.size(); ++i) {
      active[i] = i;
      rays.push_back({view_.camera.eye.cast<float>(), samples_[i].direction});
    }
    for (int layer = 0; layer < kLayers && !active.empty(); ++layer) {
      std::vector<Hit> hits(rays.size());
      view_.rays.trace(rays, hits);
      std::size_t left = 0;
      for (std::size_t k = 0; k < active.size(); ++k) {
        if (!meet(samples_[active[k]], rays[k], hits[k])) continue;
        active[left] = active[k];
        rays[left++] = rays[k];
      }
      active.resize(left);
      rays.resize(left);
    }
    for (const std::size_t i : active)
      samples_[i].own += samples_[i].through * view_.light.backdrop(samples_[i].direction);
  }

  /// What a ray does where it arrives; true when it goes on.
  bool meet(Sample& sample, Ray& ray, const Hit& hit) {
    const float down = ray.direction.y();
    const float to_floor = view_.floor && down < 0 ? (*view_.floor - ray.origin.y()) / down : hit.distance;
    const bool on_floor = view_.floor && down < 0 && to_floor < hit.distance;
    const int surface = on_floor ? Pixel::kFloor : hit.found() ? at(view_.soup.surface, hit) : Pixel::kMixed;
    sample.path = mix(sample.path ^ static_cast<std::uint64_t>(surface));
    if (on_floor) return end_on_floor(sample, ray.origin + to_floor * ray.direction);
    if (!hit.found()) {
      sample.own += sample.through * view_.light.backdrop(ray.direction);
      return false;
    }
    return meet_triangle(sample, ray, hit);
  }

  bool meet_triangle(Sample& sample, Ray& ray, const Hit& hit) {
    const geometry::Triangle& triangle = at(view_.soup.triangles, hit);
    const auto vertex = [&](std::size_t k) { return view_.soup.vertices[static_cast<std::size_t>(triangle[k])]; };
    const Vec3f outward = (vertex(1) - vertex(0)).cross(vertex(2) - vertex(0)).normalized();
    const bool leaves = outward.dot(ray.direction) > 0;
    const Look& look = view_.soup.looks[at(view_.soup.look, hit)];
    Rgb colour = Eigen::Map<const Eigen::Array3d>(look.colour.data()).cast<float>();
    if (!view_.soup.colour.empty()) colour *= blend(at(view_.soup.colour, hit), hit);
    sample.surface = at(view_.soup.surface, hit);
    sample.point = ray.origin + hit.distance * ray.direction;
    sample.outward = leaves ? Vec3f(-outward) : outward;
    sample.normal = facing(blend(at(view_.soup.normal, hit), hit).normalized(), sample.outward, ray.direction);
    sample.roughness = static_cast<float>(look.roughness);
    if (look.clear) {
      if (pass(sample, ray, hit, colour, leaves)) return true;
      sample.own += sample.through * view_.light.ambient(sample.normal);
      return false;
    }
    const auto metallic = static_cast<float>(look.metallic);
    sample.straight = kDielectric * (1 - metallic) + metallic * colour;
    sample.colour = sample.through * (metallic > 0 ? Rgb(sample.straight) : colour);
    sample.lit = true;
    return false;
  }

  /// A smooth normal on the side that is seen, turned back where it would look away from the camera.
  static Vec3f facing(Vec3f normal, const Vec3f& outward, const Vec3f& direction) {
    if (normal.dot(outward) < 0) normal = -normal;
    const float away = normal.dot(direction);
    if (away > -1e-3f) normal = (normal - (away + 1e-2f) * direction).normalized();
    return normal;
  }

  /// Through a clear surface. Light is not bent: behind what is broken there is more of it, and every bend would have
  /// to be followed to the backdrop for a picture that is not clearer.
  bool pass(Sample& sample, Ray& ray, const Hit& hit, const Rgb& colour, bool leaves) {
    if (leaves) sample.through *= colour.max(1e-3f).pow(hit.distance / kTintDepth);
    const Vec3f mirror = mirrored(ray.direction, sample.normal);
    const Rgb back = fresnel(Rgb::Constant(kDielectric), -sample.normal.dot(ray.direction));
    const Rgb glint =
        glossy(Rgb::Constant(kDielectric), sample.roughness, sample.normal, -ray.direction, view_.light.sun);
    sample.own += sample.through * (back * view_.light.sky(mirror) + glint * view_.light.sunlight);
    const float haze = sample.surface % 2 ? kCrackHaze : kSkinHaze;
    const Rgb white = 0.5f + 0.5f * colour;
    const float sun = std::max(0.0f, sample.normal.dot(view_.light.sun));
    sample.own +=
        sample.through * haze * white * (view_.light.ambient(sample.normal) + 0.5f * sun * view_.light.sunlight);
    sample.through *= (1 - back) * (1 - haze);
    ray.origin = sample.point;
    return (sample.through > kFaint).any();
  }

  bool end_on_floor(Sample& sample, const Vec3f& point) {
    const float fade = smooth_step(kFloorFadesFrom, kFloorFadesTo, Vec3f(point.x(), 0, point.z()).norm());
    sample.own += sample.through * fade * view_.light.backdrop(sample.direction);
    sample.colour = sample.through * (1 - fade) * view_.light.floor_colour;
    sample.point = point;
    sample.normal = sample.outward = Vec3f::UnitY();
    sample.surface = Pixel::kFloor;
    sample.roughness = 1;
    sample.straight.setZero();
    sample.lit = fade < 1;
    return false;
  }

  // -- From the opaque surface --

  Vec3f start(const Sample& sample) const { return sample.point + kLift * sample.outward; }

  /// Shares of light that come through along the rays.
  std::vector<float> arriving(const std::vector<Ray>& rays) const {
    std::vector<std::uint8_t> opaque(rays.size()), clear(rays.size(), 0);
    view_.rays.blocked(rays, RayScene::Kind::opaque, opaque);
    if (view_.soup.opaque < view_.soup.triangles.size()) view_.rays.blocked(rays, RayScene::Kind::clear, clear);
    std::vector<float> shares(rays.size());
    for (std::size_t i = 0; i < rays.size(); ++i) shares[i] = opaque[i] ? 0 : clear[i] ? 1 - kClearShade : 1;
    return shares;
  }

  static bool is_metal(const Sample& sample) { return (sample.straight > 0.1f).any(); }

  void light_by_sun() {
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

  void light_by_sky() {
    std::vector<Ray> rays;
    std::vector<Sample*> lit;
    for (Sample& sample : samples_) {
      if (!sample.lit || is_metal(sample)) continue;
      for (int k = 0; k < view_.sky_rays; ++k) {
        rays.push_back(
            {start(sample), cosine_weighted(sample.normal, sample.random.pair(RandomPairs::sky, k, view_.sky_rays))});
        lit.push_back(&sample);
      }
    }
    const std::vector<float> shares = arriving(rays);
    for (std::size_t i = 0; i < rays.size(); ++i) {
      Sample& sample = *lit[i];
      const float share = rays[i].direction.dot(sample.outward) > 0 ? shares[i] : 0;
      const Rgb light = share * view_.light.sky(rays[i].direction) +
                        (1 - share) * kInterreflection * view_.light.ambient(sample.normal);
      sample.light += light / static_cast<float>(view_.sky_rays);
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
      const Rgb seen = share * view_.light.sky(rays[i].direction) + (1 - share) * kInterreflection;
      if (is_metal(sample))
        sample.light += seen;
      else
        sample.own += sample.through * fresnel(sample.straight, -sample.normal.dot(sample.direction)) * seen;
    }
  }

  static constexpr float kLift = 2e-4f;  // off a surface, for rays that start on it, in sizes of the subject

  const View& view_;
  std::span<Sample> samples_;
};

}  // namespace

std::pair<float, float> SampleRandom::pair(RandomPairs purpose, int k, int count) const {
  const auto stream = static_cast<std::uint64_t>(purpose);
  const double number = index * count + k;
  const double a = random_unit(kSeed, 2 * stream, pixel) + number * 0.7548776662466927;
  const double b = random_unit(kSeed, 2 * stream + 1, pixel) + number * 0.5698402909980532;
  return {std::min(static_cast<float>(a - std::floor(a)), 0x1.fffffep-1f),
          std::min(static_cast<float>(b - std::floor(b)), 0x1.fffffep-1f)};
}

void shade(const View& view, std::span<Sample> samples) { Shader(view, samples).shade(); }

}  // namespace sunder::output::detail
