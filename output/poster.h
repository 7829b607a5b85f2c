#pragma once
/// One picture of a run: a still that says at a glance what broke and how.
#include <filesystem>
#include <optional>
#include <string>

#include "output/image.h"
#include "output/sequence.h"

namespace sunder::output {

struct PosterSettings {
  int width = 1280, height = 720;  ///< [pixels]
  int samples = 4;                 ///< camera rays through a pixel; four times as many where surfaces meet in it
  double fill = 0.76;              ///< share of the picture's width or height that what matters takes
};

/// What a picture shows besides the pieces. Y is up.
struct PosterScene {
  std::optional<double> ground_height;  ///< [m]; not set: no floor
};

/// The frame that tells most of what happened. A frame scores, for each body, its number of fragments times o exp(-o)
/// of its opening o = (s - 1) / 0.3, where s is the radius of gyration of what came of the body over that of the body
/// in one piece: at s = 1 the cracks are closed and cannot be seen, past s = 2 it cannot be seen any more what broke.
/// Of equal frames the first. A run in which nothing broke is best seen at its end: the last frame. 0 for a sequence
/// without frames.
std::size_t telling_frame(const Sequence& sequence);

/// Ray traced: sun with soft shadow, light of the sky and what hides it, reflections on smooth materials, clear ones
/// without refraction, floor and background; colours by substance, crack faces in their own, and the surface's vertex
/// colours and normals where it has some (otherwise smooth across edges under 40 degrees, flat on cracks).
/// Three-quarter view of what matters: the bodies that broke, else those that moved, else all, with what is close to
/// them; of four directions the one that shows them largest and least hidden. Lighting within surfaces is filtered.
/// The same image for any number of threads. A frame without pieces gives the empty floor; so does a `frame` that there
/// is not. Errors: ErrorKind::internal for a pose that is not finite.
Image poster_image(const Sequence& sequence, std::size_t frame, const PosterScene& scene = {},
                   const PosterSettings& settings = {});

/// poster_image as PNG.
std::string poster_png(const Sequence& sequence, std::size_t frame, const PosterScene& scene = {},
                       const PosterSettings& settings = {});

/// The telling frame as PNG file. Errors: as above, and ErrorKind::io.
void write_poster(const Sequence& sequence, std::optional<double> ground_height, const std::filesystem::path& file,
                  const PosterSettings& settings = {});

}  // namespace sunder::output
