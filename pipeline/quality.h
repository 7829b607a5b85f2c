#pragma once
/// Where on the curve of accuracy against time a run sits.
#include <optional>
#include <string>

namespace sunder::pipeline {

struct Quality {
  int particles;      ///< of a body of the scene
  double rigid_rate;  ///< rigid steps per second, rounded up to a multiple of the frame rate [1/s]

  bool operator==(const Quality&) const = default;

  static const Quality draft, preview, final;
  static constexpr int least_particles = 500, most_particles = 2'000'000;

  /// By how finely fractures are resolved; the rigid rate is that of the level below it. `particles` in
  /// [least_particles, most_particles].
  static Quality of(int particles);
};

inline constexpr Quality Quality::draft{6000, 240};
inline constexpr Quality Quality::preview{20000, 480};
inline constexpr Quality Quality::final{60000, 960};

/// "draft", "preview", "final", or the number of particles.
std::string name_of(const Quality& quality);

/// What name_of gives, read back; not set for anything else.
std::optional<Quality> quality_of(const std::string& name);

/// What was measured of results of this quality against much finer ones (docs/accuracy.md), in a sentence.
std::string accuracy_of(const Quality& quality);

/// Seconds of "90 s", "5 min" or "2 h", also without the space; a number alone is seconds. Not set for anything else,
/// or a time that is not positive.
std::optional<double> duration_of(const std::string& text);

/// What name_of can give, for messages.
std::string quality_words();

}  // namespace sunder::pipeline
