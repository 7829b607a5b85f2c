#include "pipeline/quality.h"

#include <array>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <string_view>
#include <utility>

namespace sunder::pipeline {
namespace {

constexpr std::array<std::pair<const char*, Quality>, 3> levels = {
    {{"draft", Quality::draft}, {"preview", Quality::preview}, {"final", Quality::final}}};

/// Means of docs/accuracy.md, of solves with so many particles against those with 160000 and more.
struct Measured {
  int particles;
  double cracks, fragments, force;  ///< distance [body diagonal]; relative
};
constexpr std::array<Measured, 5> ladder = {{{5000, 0.056, 0.27, 0.38},
                                             {10000, 0.051, 0.46, 0.26},
                                             {20000, 0.045, 0.37, 0.14},
                                             {40000, 0.038, 0.41, 0.09},
                                             {80000, 0.044, 0.86, 0.10}}};
constexpr double cracks_between_seeds = 0.030;

}  // namespace

Quality Quality::of(int particles) {
  double rate = draft.rigid_rate;
  for (const auto& [name, level] : levels)
    if (level.particles <= particles) rate = level.rigid_rate;
  return {particles, rate};
}

std::string name_of(const Quality& quality) {
  for (const auto& [name, level] : levels)
    if (level == quality) return name;
  return std::to_string(quality.particles);
}

std::optional<Quality> quality_of(const std::string& name) {
  for (const auto& [word, level] : levels)
    if (word == name) return level;
  int particles = 0;
  const char* end = name.data() + name.size();
  const auto read = std::from_chars(name.data(), end, particles);
  if (read.ec != std::errc() || read.ptr != end) return {};
  if (particles < Quality::least_particles || particles > Quality::most_particles) return {};
  return Quality::of(particles);
}

std::string accuracy_of(const Quality& quality) {
  const Measured* nearest = &ladder[0];
  for (const Measured& m : ladder)
    if (m.particles <= quality.particles) nearest = &m;
  const bool within = quality.particles >= ladder.front().particles && quality.particles < 2 * ladder.back().particles;
  char text[400];
  std::snprintf(
      text, sizeof text,
      "quality %s, measured on five scenes against solves of 160000 particles and more%s: cracks lie %.1f %% of "
      "the body's diagonal from theirs (those of another seed %.1f %%), the number of fragments differs by "
      "%.0f %%, peak contact forces by %.0f %%",
      name_of(quality).c_str(), within ? "" : " (nearest that was measured)", 100 * nearest->cracks,
      100 * cracks_between_seeds, 100 * nearest->fragments, 100 * nearest->force);
  return text;
}

std::optional<double> duration_of(const std::string& text) {
  double number = 0;
  const char* end = text.data() + text.size();
  const auto read = std::from_chars(text.data(), end, number);
  if (read.ec != std::errc() || !(number > 0) || !std::isfinite(number)) return {};
  std::string unit(read.ptr, end);
  unit.erase(0, unit.find_first_not_of(' '));
  constexpr std::array<std::pair<std::string_view, double>, 4> units = {{{"", 1}, {"s", 1}, {"min", 60}, {"h", 3600}}};
  for (const auto& [name, seconds] : units)
    if (unit == name) return number * seconds;
  return {};
}

std::string quality_words() {
  return "draft, preview, final or the number of particles of a body, from " +
         std::to_string(Quality::least_particles) + " to " + std::to_string(Quality::most_particles);
}

}  // namespace sunder::pipeline
