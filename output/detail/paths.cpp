#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/random.h"
#include "output/detail/samples.h"

namespace sunder::output::detail {
namespace {

constexpr int kLayers = 12;         // of clear surfaces that a ray goes through
constexpr float kFaint = 0.08f;     // share of light from behind that is not worth following
constexpr float kTintDepth = 0.6f;  // of clear material that gives light its colour, in sizes of the subject
constexpr float kCrackHaze = 0.22f, kSkinHaze = 0.03f;       // share of light that clear surfaces scatter like paper
constexpr float kFloorFadesFrom = 2.5f, kFloorFadesTo = 11;  // distance from the subject, in its sizes

template <class List>
const auto& at(const List& list, const Hit& hit) {
  return list[static_cast<std::size_t>(hit.triangle)];
}

template <class Corners>
auto blend(const Corners& corners, const Hit& hit) {
  return ((1 - hit.u - hit.v) * corners[0] + hit.u * corners[1] + hit.v * corners[2]).eval();
}

/// From the camera to the surfaces.
class Paths {
 public:
  Paths(const View& view, std::span<Sample> samples) : view_(view), samples_(samples) {}

  void follow() {
    std::vector<Ray> rays;
    for (const Sample& sample : samples_) rays.push_back({view_.camera.eye.cast<float>(), sample.direction});
    std::vector<Hit> ends(rays.size());
    view_.rays.trace(rays, RayScene::Kind::opaque, ends);
    for (std::size_t i = 0; i < rays.size(); ++i) rays[i].far = std::min(ends[i].distance, floor_distance(rays[i]));
    const std::vector<bool> arrives = pass_clear(rays);
    for (std::size_t i = 0; i < samples_.size(); ++i)
      if (arrives[i]) end(samples_[i], ends[i]);
  }

 private:
  float floor_distance(const Ray& ray) const {
    constexpr float kInfinity = std::numeric_limits<float>::infinity();
    if (!view_.floor || ray.direction.y() >= 0) return kInfinity;
    const float distance = (*view_.floor - ray.origin.y()) / ray.direction.y();
    return distance > 0 ? distance : kInfinity;
  }

  /// Through all clear surfaces on the way; which rays bring something from behind them.
  std::vector<bool> pass_clear(std::vector<Ray>& rays) {
    std::vector<bool> arrives(rays.size(), true);
    if (!view_.rays.has(RayScene::Kind::clear)) return arrives;
    std::vector<std::size_t> active(rays.size());
    std::iota(active.begin(), active.end(), 0);
    for (int layer = 0; layer < kLayers && !active.empty(); ++layer) {
      std::vector<Hit> hits(active.size());
      view_.rays.trace(std::span(rays).first(active.size()), RayScene::Kind::clear, hits);
      std::size_t left = 0;
      for (std::size_t k = 0; k < active.size(); ++k) {
        if (!hits[k].found()) continue;
        Sample& sample = samples_[active[k]];
        arrives[active[k]] = pass(sample, rays[k], hits[k]);
        if (!arrives[active[k]]) continue;
        active[left] = active[k];
        rays[left++] = rays[k];
      }
      active.resize(left);
    }
    return arrives;
  }

  /// At the opaque surface, the floor or the backdrop.
  void end(Sample& sample, const Hit& hit) {
    const Ray ray{view_.camera.eye.cast<float>(), sample.direction};
    const float to_floor = floor_distance(ray);
    if (to_floor < hit.distance) return end_on_floor(sample, ray.origin + to_floor * ray.direction);
    if (hit.found()) return end_on_triangle(sample, ray, hit);
    enter(sample, Pixel::kMixed);
    sample.own += sample.through * view_.light.backdrop(ray.direction);
  }

  static void enter(Sample& sample, int surface) {
    sample.path = mix(sample.path ^ static_cast<std::uint64_t>(surface));
    sample.surface = surface;
  }

  Vec3f triangle_normal(const Hit& hit) const {
    const geometry::Triangle& triangle = at(view_.soup.triangles, hit);
    const auto vertex = [&](std::size_t k) { return view_.soup.vertices[static_cast<std::size_t>(triangle[k])]; };
    return (vertex(1) - vertex(0)).cross(vertex(2) - vertex(0)).normalized();
  }

  /// Fills in the sample's point, its normals and surface; returns the colour there.
  Rgb meet(Sample& sample, const Ray& ray, const Hit& hit, const Look& look) {
    const Vec3f outward = triangle_normal(hit);
    enter(sample, at(view_.soup.surface, hit));
    sample.point = ray.origin + hit.distance * ray.direction;
    sample.outward = outward.dot(ray.direction) > 0 ? Vec3f(-outward) : outward;
    sample.normal = facing(blend(at(view_.soup.normal, hit), hit).normalized(), sample.outward, ray.direction);
    sample.roughness = static_cast<float>(look.roughness);
    Rgb colour = Eigen::Map<const Eigen::Array3d>(look.colour.data()).cast<float>();
    if (!view_.soup.colour.empty()) colour *= blend(at(view_.soup.colour, hit), hit);
    return colour;
  }

  void end_on_triangle(Sample& sample, const Ray& ray, const Hit& hit) {
    const Look& look = view_.soup.looks[at(view_.soup.look, hit)];
    const Rgb colour = meet(sample, ray, hit, look);
    const auto metallic = static_cast<float>(look.metallic);
    sample.straight = kDielectric * (1 - metallic) + metallic * colour;
    sample.colour = sample.through * (metallic > 0 ? Rgb(sample.straight) : colour);
    sample.lit = true;
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
  bool pass(Sample& sample, Ray& ray, const Hit& hit) {
    const Look& look = view_.soup.looks[at(view_.soup.look, hit)];
    const Rgb colour = meet(sample, ray, hit, look);
    const bool leaves = triangle_normal(hit).dot(ray.direction) > 0;
    if (leaves) sample.through *= colour.max(1e-3f).pow(hit.distance / kTintDepth);
    const Vec3f mirror = mirrored(ray.direction, sample.normal);
    const Rgb back = fresnel(Rgb::Constant(kDielectric), -sample.normal.dot(ray.direction));
    const Rgb glint =
        glossy(Rgb::Constant(kDielectric), sample.roughness, sample.normal, -ray.direction, view_.light.sun);
    sample.own += sample.through * (back * view_.light.reflected(mirror) + glint * view_.light.sunlight);
    const float haze = sample.surface % 2 ? kCrackHaze : kSkinHaze;
    const Rgb white = 0.5f + 0.5f * colour;
    const float sun = std::max(0.0f, sample.normal.dot(view_.light.sun));
    sample.own +=
        sample.through * haze * white * (view_.light.ambient(sample.normal) + 0.5f * sun * view_.light.sunlight);
    sample.through *= (1 - back) * (1 - haze);
    ray.origin = sample.point;
    ray.far -= hit.distance;
    if ((sample.through > kFaint).any()) return true;
    sample.own += sample.through * view_.light.ambient(sample.normal);
    return false;
  }

  void end_on_floor(Sample& sample, const Vec3f& point) {
    const float fade = smooth_step(kFloorFadesFrom, kFloorFadesTo, Vec3f(point.x(), 0, point.z()).norm());
    sample.own += sample.through * fade * view_.light.backdrop(sample.direction);
    sample.colour = sample.through * (1 - fade) * view_.light.floor_colour;
    sample.point = point;
    sample.normal = sample.outward = Vec3f::UnitY();
    enter(sample, Pixel::kFloor);
    sample.roughness = 1;
    sample.straight.setZero();
    sample.lit = fade < 1;
  }

  const View& view_;
  std::span<Sample> samples_;
};

}  // namespace

void follow(const View& view, std::span<Sample> samples) { Paths(view, samples).follow(); }

}  // namespace sunder::output::detail
