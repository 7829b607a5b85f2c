#pragma once
/// Rays through pixels and what they find.
#include <span>
#include <utility>

#include "output/detail/render.h"

namespace sunder::output::detail {

/// What pairs of random numbers are for.
enum class RandomPairs : std::uint64_t { lens, sun, sky, mirror };

/// Of one sample of a pixel.
struct SampleRandom {
  std::uint64_t pixel = 0;
  int index = 0;  ///< of the sample

  /// In [0, 1), spread evenly over the samples of a pixel: the sequence of Roberts ("The unreasonable effectiveness of
  /// quasirandom sequences", 2018), begun at a random point for each pixel and purpose.
  std::pair<float, float> pair(RandomPairs purpose) const;
};

struct Sample {
  SampleRandom random;
  Vec3f direction = Vec3f::UnitZ();                                  ///< from the camera
  Rgb own = Rgb::Zero(), colour = Rgb::Zero(), light = Rgb::Zero();  ///< as those of Pixel
  std::uint64_t path = 0;                                            ///< equal for samples that met the same surfaces
  bool lit = false;  ///< the opaque surface it ends at is not empty space; the rest describes it
  int surface = 0;
  Vec3f point = Vec3f::Zero(), normal = Vec3f::Zero(), outward = Vec3f::Zero();  ///< `outward`: of the flat triangle
  float roughness = 1;
  Rgb straight = Rgb::Zero();  ///< reflectance at normal incidence
  Rgb through = Rgb::Ones();   ///< share of light that what is clear lets through to the camera
};

/// The camera rays through clear surfaces to opaque ones, the floor or the backdrop. (paths.cpp)
void follow(const View& view, std::span<Sample> samples);

/// Sun, sky and reflections on the surfaces where they end. (lighting.cpp)
void illuminate(const View& view, std::span<Sample> samples);

}  // namespace sunder::output::detail
