#pragma once
/// From triangles to light in pixels.
#include <optional>
#include <vector>

#include "output/detail/camera.h"
#include "output/detail/light.h"
#include "output/detail/ray_scene.h"

namespace sunder::output::detail {

/// What a pixel sends to the camera: own + colour * light. Only `light` is worth filtering: it is what random rays
/// found.
struct Pixel {
  static constexpr int kMixed = -1, kFloor = -2;

  Rgb own = Rgb::Zero(), colour = Rgb::Zero(), light = Rgb::Zero();
  float variance = 0;    ///< of the luminance of `light`, as the mean of its samples
  int surface = kMixed;  ///< of the soup, or the floor; mixed: none or more than one, all is in `own`
  Vec3f point = Vec3f::Zero(), normal = Vec3f::Zero();
};

struct View {
  const Soup& soup;
  const RayScene& rays;
  Camera camera;
  Light light;
  std::optional<float> floor;  ///< height, in the soup's coordinates
  int width = 0, height = 0;   ///< [pixels]
  int samples = 4;             ///< camera rays of a pixel, each with one ray to the sun and one to the sky
};

/// Rows from the top. In parallel; random numbers depend on the pixel alone.
std::vector<Pixel> render(const View& view);

}  // namespace sunder::output::detail
