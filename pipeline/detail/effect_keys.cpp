#include "pipeline/detail/effect_keys.h"

#include <algorithm>
#include <array>

#include "pipeline/detail/material_keys.h"

namespace sunder::pipeline::detail {
namespace {

Ask read_ask(const Value& value) {
  constexpr std::array<std::pair<std::string_view, Ask>, 3> kAsks = {
      {{"off", Ask::off}, {"on", Ask::on}, {"auto", Ask::automatic}}};
  if (value.is_flag()) return value.flag() ? Ask::on : Ask::off;
  if (!value.is_text()) value.fail_type("\"off\", \"on\" or \"auto\"");
  return value.word<Ask>(kAsks);
}

template <Effect effect>
void read_effect(const Value& value, EffectSettings& settings) {
  settings.asked[effect] = read_ask(value);
}

constexpr std::array<Key<EffectSettings>, effect_count + 5> kEffectKeys = {{
    {"fracture", read_effect<Effect::fracture>},
    {"secondary_fracture", read_effect<Effect::secondary_fracture>},
    {"flaws", read_effect<Effect::flaws>},
    {"scatter_length",
     [](const Value& value, EffectSettings& settings) { settings.scatter_length = value.positive(); }},
    {"two_velocity_fields", read_effect<Effect::two_velocity_fields>},
    {"surface_detail", read_effect<Effect::surface_detail>},
    {"surface_look",
     [](const Value& value, EffectSettings& settings) { settings.surface_look = read_surface_look(value); }},
    {"hairlines", read_effect<Effect::hairlines>},
    {"hairline_width",
     [](const Value& value, EffectSettings& settings) { settings.hairline_width = value.positive(); }},
    {"smallest_detail",
     [](const Value& value, EffectSettings& settings) { settings.smallest_detail = value.non_negative(); }},
    {"debris", read_effect<Effect::debris>},
    {"debris_size", [](const Value& value, EffectSettings& settings) { settings.debris_size = value.positive(); }},
    {"energy_ledger", read_effect<Effect::energy_ledger>},
}};

bool takes(const EffectInfo& info, std::string_view parameter) {
  return std::find(info.parameters.begin(), info.parameters.end(), parameter) != info.parameters.end();
}

void check_parameter(const Section& section, const EffectSettings& settings, std::string_view parameter) {
  std::string names;
  for (const EffectInfo& info : effect_registry()) {
    if (!takes(info, parameter)) continue;
    if (settings.asked[info.effect] != Ask::off) return;
    names += (names.empty() ? "" : " and ") + std::string(info.name);
  }
  const std::string key(parameter);
  section.fail_at(parameter, key + ": a parameter of " + names + ", switched off; remove it or what switches that off");
}

}  // namespace

std::span<const Key<EffectSettings>> effect_keys() { return kEffectKeys; }

void check_effects(const Section& section, const EffectSettings& settings) {
  for (const EffectInfo& info : effect_registry()) {
    for (const std::string_view parameter : info.parameters)
      if (!parameter.empty() && section.has(parameter)) check_parameter(section, settings, parameter);
    if (settings.asked[info.effect] == Ask::on && !info.needs.empty() && !section.has(info.needs))
      section.fail_at(info.name, std::string(info.name) + ": missing key '" + std::string(info.needs) +
                                     "', without which it cannot be switched on");
  }
}

}  // namespace sunder::pipeline::detail
