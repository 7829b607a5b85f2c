#include <array>

#include "crack/surface_detail.h"

namespace sunder::crack {

namespace {

/// Lengths in units of the scale.
struct Look {
  const char* name;
  double edge, step, length, radius, spacing, height, share, grain, grain_size;
};

constexpr std::array<Look, 8> looks = {{
    {"clay", 0.012, 0.030, 0.15, 0.060, 0.050, 0.045, 0.7, 0.6, 0.14},
    {"rock", 0.008, 0.030, 0.20, 0.050, 0.018, 0.060, 0.5, 0.7, 0.085},
    {"concrete", 0.008, 0.015, 0.05, 0.030, 0.012, 0.026, 0.4, 0.8, 0.045},
    {"glass", 0.007, 0.030, 1.20, 0.030, 0.010, 0.005, 0.25, 0.0, 0.0},
    {"slate", 0.008, 0.100, 2.00, 0.060, 0.018, 0.024, 1.0, 0.0, 0.0},
    {"ceramic", 0.007, 0.014, 0.12, 0.016, 0.009, 0.0035, 0.6, 0.1, 0.02},
    {"plaster", 0.007, 0.012, 0.04, 0.012, 0.010, 0.009, 0.5, 0.85, 0.018},
    {"metal", 0.007, 0.014, 0.10, 0.010, 0.009, 0.013, 1.0, 0.35, 0.025},
}};

}  // namespace

std::vector<std::string> detail_preset_names() {
  std::vector<std::string> names;
  for (const Look& look : looks) names.emplace_back(look.name);
  return names;
}

DetailSettings detail_preset(const std::string& name, double scale) {
  std::string known;
  for (const Look& look : looks) {
    if (name == look.name)
      return {.edge_length = look.edge * scale,
              .line_step = look.step * scale,
              .line_length = look.length * scale,
              .influence_radius = look.radius * scale,
              .grid_spacing = look.spacing * scale,
              .height = look.height * scale,
              .longest_share = look.share,
              .grain = look.grain,
              .grain_size = look.grain_size * scale};
    known += (known.empty() ? "" : ", ") + std::string(look.name);
  }
  throw Error(ErrorKind::usage, "there is no surface detail '" + name + "'; known are " + known);
}

}  // namespace sunder::crack
