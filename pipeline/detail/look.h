#pragma once
/// How a material looks in the files that carry colours.
#include <array>
#include <string_view>

namespace sunder::pipeline::detail {

/// Linear RGB in [0, 1] and the two numbers of the metallic-roughness model.
struct Look {
  std::array<double, 3> outside = {0.6, 0.6, 0.6};
  std::array<double, 3> inside = {0.45, 0.42, 0.4};
  double metallic = 0, roughness = 0.7;
};

/// The look of the preset whose name `material` contains ("thin_glass" looks like glass); grey otherwise.
Look look_of(std::string_view material);

}  // namespace sunder::pipeline::detail
