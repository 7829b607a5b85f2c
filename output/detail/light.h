#pragma once
/// The studio: a sun, a sky with a soft box in it, a floor and a backdrop.
#include <algorithm>

#include "output/detail/camera.h"
#include "output/detail/ray_scene.h"
#include "output/detail/soup.h"

namespace sunder::output::detail {

constexpr float kDielectric = 0.04f;  ///< reflectance at normal incidence of all that is no metal

/// From 0 up to `from` to 1 beyond `to`.
inline float smooth_step(float from, float to, float x) {
  const float t = std::clamp((x - from) / (to - from), 0.0f, 1.0f);
  return t * t * (3 - 2 * t);
}

inline Vec3f mirrored(const Vec3f& direction, const Vec3f& normal) {
  return direction - 2 * direction.dot(normal) * normal;
}

/// Radiances are relative. All directions have unit length.
struct Light {
  Vec3f sun = Vec3f::UnitY();             ///< towards it
  Vec3f box = Vec3f::UnitY();             ///< towards the middle of the soft box
  Rgb sunlight = Rgb(2.4f, 2.25f, 2.0f);  ///< that a white matt surface facing the sun sends back
  Rgb floor_colour = Rgb(0.17f, 0.175f, 0.185f);
  bool has_floor = false;

  /// What arrives from a direction: the sky, below the horizon the floor.
  Rgb sky(const Vec3f& direction) const;

  /// With the soft box, which only reflections show: to matt surfaces it would be little light and much noise.
  Rgb reflected(const Vec3f& direction) const;

  /// That a white matt surface with this normal sends back of the sky alone, if nothing is in the way. Approximate.
  Rgb ambient(const Vec3f& normal) const;

  /// What the camera sees where there is nothing.
  Rgb backdrop(const Vec3f& direction) const;
};

/// Sun from above one shoulder of the camera, soft box from the other side: the sun on the left, unless it reaches
/// clearly more of the samples of the subject's surface from the right.
Light light_for(const Camera& camera, const RayScene& scene, std::span<const Vec3> samples, bool has_floor);

/// Schlick, "An inexpensive BRDF model for physically-based rendering" (1994), for reflectance `straight` at normal
/// incidence.
Rgb fresnel(const Rgb& straight, float cosine);

/// Towards a light by the microfacet model with the GGX distribution (Walter et al., "Microfacet models for refraction
/// through rough surfaces", 2007) and the visibility term of Kelemen and Szirmay-Kalos (2001), times the cosine.
Rgb glossy(const Rgb& straight, float roughness, const Vec3f& normal, const Vec3f& to_eye, const Vec3f& to_light);

/// sRGB of a radiance, through a filmic curve (Narkowicz, "ACES filmic tone mapping curve", 2016).
std::array<std::uint8_t, 3> developed(const Rgb& radiance);

}  // namespace sunder::output::detail
