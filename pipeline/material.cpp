#include "pipeline/material.h"

#include <array>
#include <cmath>

#include "crack/surface_detail.h"
#include "pipeline/detail/material_keys.h"

namespace sunder::pipeline {
namespace detail {
namespace {

void read_poisson_ratio(const Value& value, Material& material) {
  material.poisson_ratio = value.number();
  // The range in which an isotropic solid is stable; 0.5 itself is incompressible and has no finite bulk modulus.
  if (material.poisson_ratio <= -1 || material.poisson_ratio >= 0.5) {
    value.fail("expected a number above -1 and below 0.5");
  }
}

constexpr std::array<Key<Material>, 12> kMaterialKeys = {{
    {"density", [](const Value& value, Material& material) { material.density = value.positive(); }},
    {"youngs_modulus", [](const Value& value, Material& material) { material.youngs_modulus = value.positive(); }},
    {"poisson_ratio", read_poisson_ratio},
    {"tensile_strength", [](const Value& value, Material& material) { material.tensile_strength = value.positive(); }},
    {"fracture_energy", [](const Value& value, Material& material) { material.fracture_energy = value.positive(); }},
    {"contact_pressure", [](const Value& value, Material& material) { material.contact_pressure = value.positive(); }},
    {"weibull_modulus",
     [](const Value& value, Material& material) { material.weibull_modulus = value.non_negative(); }},
    {"restitution", [](const Value& value, Material& material) { material.restitution = value.within(0, 1); }},
    {"friction", [](const Value& value, Material& material) { material.friction = value.non_negative(); }},
    {"breakable", [](const Value& value, Material& material) { material.breakable = value.flag(); }},
    {"surface_look", [](const Value& value, Material& material) { material.surface_look = read_surface_look(value); }},
    {"source", [](const Value& value, Material& material) { material.source = value.text(); }},
}};

}  // namespace

std::span<const Key<Material>> material_keys() { return kMaterialKeys; }

std::string read_surface_look(const Value& value) {
  const std::vector<std::string> names = crack::detail_preset_names();
  std::vector<std::pair<std::string_view, std::string>> looks;
  for (const std::string& name : names) looks.emplace_back(name, name);
  return value.word<std::string>(looks);
}

void check_complete(const Section& section, const Material& material) {
  const auto require = [&](std::string_view key, double value) {
    if (value == 0) section.fail("missing key '" + std::string(key) + "'");
  };
  require("density", material.density);
  require("youngs_modulus", material.youngs_modulus);
  require("contact_pressure", material.contact_pressure);
  if (!material.breakable) return;
  require("tensile_strength", material.tensile_strength);
  require("fracture_energy", material.fracture_energy);
}

}  // namespace detail

MaterialLibrary load_materials(const std::filesystem::path& file) {
  const toml::table document = detail::parse_file(file);
  MaterialLibrary library;
  for (const auto& [key, node] : document) {
    const std::string name(key.str());
    const toml::table* table = node.as_table();
    if (!table) detail::fail(file, static_cast<int>(key.source().begin.line), "'" + name + "' is not a [section]");
    const detail::Section section{file, *table, "material '" + name + "'"};
    Material material;
    material.name = name;
    detail::read_section(section, detail::material_keys(), material);
    detail::check_complete(section, material);
    library.emplace(name, material);
  }
  return library;
}

double crack_through_energy(const Material& material, double volume) {
  return material.fracture_energy * std::pow(volume, 2.0 / 3);
}

}  // namespace sunder::pipeline
