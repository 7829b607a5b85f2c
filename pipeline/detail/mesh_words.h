#pragma once
/// The words that describe a mesh file's axes and unit.
#include <array>

#include "geometry/load.h"
#include "pipeline/detail/toml_reader.h"

namespace sunder::pipeline::detail {

inline geometry::UpAxis read_up_axis(const Value& value) {
  using geometry::UpAxis;
  constexpr std::array<std::pair<std::string_view, UpAxis>, 3> kAxes = {
      {{"x", UpAxis::x}, {"y", UpAxis::y}, {"z", UpAxis::z}}};
  return value.word<UpAxis>(kAxes);
}

/// Metres per unit.
inline double read_unit_length(const Value& value) {
  constexpr std::array<std::pair<std::string_view, double>, 5> kMetres = {
      {{"m", 1}, {"cm", 0.01}, {"mm", 0.001}, {"in", 0.0254}, {"ft", 0.3048}}};
  return value.word<double>(kMetres);
}

}  // namespace sunder::pipeline::detail
