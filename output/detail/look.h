#pragma once
/// How a surface looks in the files that carry colours.
#include <array>
#include <string>

namespace sunder::output::detail {

/// Linear RGB in [0, 1], the two numbers of the metallic-roughness model, and whether one can look through.
struct Look {
  std::array<double, 3> colour = {0.6, 0.6, 0.6};
  double metallic = 0, roughness = 0.7;
  bool clear = false;  ///< light goes through

  bool operator==(const Look&) const = default;
};

/// Of the surface material `name` on a body of `substance`: that of the preset whose name the substance contains
/// ("thin_glass" looks like glass), grey for others; crack faces, by their name, have a tint of their own.
Look look_of(const std::string& name, const std::string& substance);

}  // namespace sunder::output::detail
