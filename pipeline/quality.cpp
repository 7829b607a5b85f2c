#include "pipeline/quality.h"

#include <array>
#include <charconv>
#include <cmath>
#include <string_view>
#include <utility>

namespace sunder::pipeline {
namespace {

constexpr std::array<std::pair<const char*, Quality>, 3> levels = {
    {{"draft", Quality::draft}, {"preview", Quality::preview}, {"final", Quality::final}}};

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

std::string accuracy_of(const Quality& quality) { return "quality " + name_of(quality); }

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
