#pragma once
/// The words that describe a mesh file's axes.
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

}  // namespace sunder::pipeline::detail
