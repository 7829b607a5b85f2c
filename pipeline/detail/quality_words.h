#pragma once
/// How files write a quality and a seed.
#include <array>
#include <limits>

#include "pipeline/detail/toml_reader.h"
#include "pipeline/quality.h"

namespace sunder::pipeline::detail {

inline Quality read_quality_level(const Value& value) {
  if (value.is_integer())
    return Quality::of(static_cast<int>(value.integer(Quality::least_particles, Quality::most_particles)));
  constexpr std::array<std::pair<std::string_view, Quality>, 3> kQualities = {
      {{"draft", Quality::draft}, {"preview", Quality::preview}, {"final", Quality::final}}};
  return value.word<Quality>(kQualities);
}

inline std::uint64_t read_seed_value(const Value& value) {
  return static_cast<std::uint64_t>(value.integer(0, std::numeric_limits<std::int64_t>::max()));
}

}  // namespace sunder::pipeline::detail
