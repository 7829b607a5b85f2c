#include "output/detail/look.h"

#include "output/sequence.h"

namespace sunder::output::detail {
namespace {

struct Preset {
  std::string_view substance;
  std::array<double, 3> outside, inside;
  double metallic, roughness;
  bool clear = false;
};

// Crack faces are a little darker or lighter than the skin, so that they read at a glance.
constexpr std::array<Preset, 11> kPresets = {{
    {"glass", {0.55, 0.78, 0.80}, {0.30, 0.60, 0.62}, 0, 0.1, true},
    {"porcelain", {0.85, 0.87, 0.90}, {0.72, 0.68, 0.60}, 0, 0.25},
    {"terracotta", {0.55, 0.20, 0.10}, {0.65, 0.32, 0.18}, 0, 0.85},
    {"plaster", {0.82, 0.80, 0.76}, {0.90, 0.89, 0.87}, 0, 0.95},
    {"concrete", {0.40, 0.40, 0.39}, {0.52, 0.50, 0.47}, 0, 0.95},
    {"marble", {0.80, 0.79, 0.77}, {0.92, 0.92, 0.92}, 0, 0.4},
    {"brick", {0.42, 0.13, 0.08}, {0.52, 0.22, 0.14}, 0, 0.9},
    {"ice", {0.70, 0.85, 0.95}, {0.88, 0.94, 0.98}, 0, 0.2, true},
    {"stone", {0.33, 0.32, 0.30}, {0.45, 0.43, 0.40}, 0, 0.9},
    {"steel", {0.50, 0.52, 0.55}, {0.40, 0.41, 0.43}, 1, 0.3},
    {"wood", {0.35, 0.20, 0.10}, {0.55, 0.38, 0.20}, 0, 0.7},
}};

}  // namespace

Look look_of(const std::string& name, const std::string& substance) {
  const bool inside = name == inside_material(substance);
  for (const Preset& preset : kPresets)
    if (substance.find(preset.substance) != std::string::npos)
      return {inside ? preset.inside : preset.outside, preset.metallic, preset.roughness, preset.clear};
  if (inside) return {{0.45, 0.42, 0.4}};
  return {};
}

}  // namespace sunder::output::detail
