#include "batch/detail/job_keys.h"

#include <algorithm>
#include <array>
#include <numbers>

#include <nlohmann/json.hpp>

#include "crack/surface_detail.h"
#include "pipeline/detail/body_keys.h"
#include "pipeline/detail/mesh_catalogue.h"
#include "pipeline/detail/mesh_words.h"
#include "pipeline/detail/quality_words.h"
#include "pipeline/detail/scene_override.h"

namespace sunder::batch::detail {
namespace {

namespace fs = std::filesystem;
using namespace pipeline;
using pipeline::detail::Key;
using pipeline::detail::Value;

constexpr double usual_angle = std::numbers::pi / 4;  // beyond it impactors glance off

struct Draft {
  FractureJob job;
  bool random_impact = false;
  double largest_angle = usual_angle;
};

void read_impact(const Value& value, Draft& draft) {
  constexpr std::array<std::pair<std::string_view, bool>, 1> kWays = {{{"random", true}}};
  draft.random_impact = value.word<bool>(kWays);
}

void read_material(const Value& value, Draft& draft) {
  static const MaterialLibrary materials = load_materials(default_assets().materials);
  const Material& material = pipeline::detail::find_material(value, materials);
  if (!material.breakable) value.fail("material '" + material.name + "' does not break");
  draft.job.options.material = material.name;
}

void switch_on(Draft& draft, Effect effect) { draft.job.options.effects.asked[effect] = Ask::on; }

void read_detail(const Value& value, Draft& draft) {
  std::vector<std::pair<std::string_view, std::string_view>> looks;
  static const std::vector<std::string> names = crack::detail_preset_names();
  for (const std::string& name : names) looks.emplace_back(name, name);
  draft.job.options.effects.surface_look = value.word<std::string_view>(looks);
  switch_on(draft, Effect::surface_detail);
}

void read_cut(const Value& value, Draft& draft) {
  constexpr std::array<std::pair<std::string_view, bool>, 2> kWays = {{{"exact", false}, {"level_set", true}}};
  draft.job.options.fracture.level_set_cut = value.word<bool>(kWays);
}

constexpr std::array<Key<Draft>, 20> kKeys = {{
    {"mesh", [](const Value& value, Draft& draft) { draft.job.options.mesh = value.text(); }, true},
    {"unit", [](const Value& value,
                Draft& draft) { draft.job.options.load.metres_per_unit = pipeline::detail::read_unit_length(value); }},
    {"up", [](const Value& value, Draft& draft) { draft.job.options.load.up = pipeline::detail::read_up_axis(value); }},
    {"part", [](const Value& value, Draft& draft) { draft.job.options.load.part = value.text(); }},
    {"height", [](const Value& value, Draft& draft) { draft.job.options.height = value.positive(); }},
    {"material", read_material},
    {"quality",
     [](const Value& value, Draft& draft) { draft.job.options.quality = pipeline::detail::read_quality_level(value); }},
    {"seed",
     [](const Value& value, Draft& draft) { draft.job.options.seed = pipeline::detail::read_seed_value(value); }},
    {"impact", read_impact},
    {"largest_angle",
     [](const Value& value, Draft& draft) { draft.largest_angle = value.within(1, 85) * std::numbers::pi / 180; }},
    {"at", [](const Value& value, Draft& draft) { draft.job.options.at = value.vector(); }},
    {"direction", [](const Value& value, Draft& draft) { draft.job.options.direction = value.vector(); }},
    {"impulse", [](const Value& value, Draft& draft) { draft.job.options.impulse = value.positive(); }},
    {"severity", [](const Value& value, Draft& draft) { draft.job.options.severity = value.positive(); }},
    {"speed", [](const Value& value, Draft& draft) { draft.job.options.speed = value.positive(); }},
    {"cells",
     [](const Value& value, Draft& draft) { draft.job.options.cells = static_cast<int>(value.integer(2, 100000)); }},
    {"detail", read_detail},
    {"debris",
     [](const Value& value, Draft& draft) {
       draft.job.options.effects.debris_size = value.positive();
       switch_on(draft, Effect::debris);
     }},
    {"hairlines",
     [](const Value& value, Draft& draft) {
       draft.job.options.effects.hairline_width = value.positive();
       switch_on(draft, Effect::hairlines);
     }},
    {"cut", read_cut},
}};

const Key<Draft>& key_of(const std::string& name) {
  for (const Key<Draft>& key : kKeys)
    if (key.name == name) return key;
  throw Error(ErrorKind::usage, "there is no parameter '" + name + "'" +
                                    pipeline::detail::suggestion(name, pipeline::detail::key_names<Draft>(kKeys)));
}

bool is_file_name(const std::string& subject) { return subject.find_first_of("./") != std::string::npos; }

bool has(const std::vector<std::string>& names, std::string_view name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

/// "scene.seed" for "seed"; other parameters of mode run are the keys of a scene as they are.
std::string scene_key(const std::string& parameter) {
  return parameter.find('.') == std::string::npos ? "scene." + parameter : parameter;
}

}  // namespace

std::vector<std::string> fracture_parameters() { return pipeline::detail::key_names<Draft>(kKeys); }

void check_fracture_value(const std::string& parameter, const Value& value) {
  Draft draft;
  key_of(parameter).read(value, draft);
}

std::string conflict(const std::vector<std::string>& parameters) {
  const auto both = [&](const char* a, const char* b) { return has(parameters, a) && has(parameters, b); };
  const auto pair = [](const char* a, const char* b) {
    return std::string("give '") + a + "' or '" + b + "', not both";
  };
  if (has(parameters, "cells")) {
    for (const char* other : {"impact", "at", "direction", "largest_angle", "impulse", "severity", "speed"})
      if (has(parameters, other)) return std::string("'cells' shatters without an impact: leave out '") + other + "'";
    return "";
  }
  if (both("impact", "at")) return pair("impact", "at");
  if (both("impact", "direction")) return pair("impact", "direction");
  if (both("impulse", "severity")) return pair("impulse", "severity");
  if (!has(parameters, "impact") && !has(parameters, "at"))
    return "where is it hit? Give impact = \"random\", or points for 'at'; or 'cells' for a shatter without physics";
  if (!has(parameters, "impulse") && !has(parameters, "severity"))
    return "how hard is it hit? Give 'severity' (1: could just open one crack) or 'impulse' [N s]";
  if (has(parameters, "largest_angle") && !has(parameters, "impact")) return "'largest_angle' is of random impacts";
  return "";
}

FractureJob fracture_job(const Plan& plan, const Job& job) {
  Draft draft;
  for (const Parameter& parameter : job.parameters) {
    if (parameter.name == "sample") continue;
    const toml::table parsed = pipeline::detail::parsed_value(parameter.name, parameter.value);
    key_of(parameter.name).read(Value(plan.file, *parsed.get("value"), parameter.name), draft);
  }
  fs::path& mesh = draft.job.options.mesh;
  if (is_file_name(mesh.string())) mesh = plan.file.parent_path() / mesh;
  if (draft.random_impact) draft.job.random_impact = draft.largest_angle;
  return draft.job;
}

Scene scene_of(const Plan& plan, const Job& job) {
  std::vector<Override> overrides;
  for (const Parameter& parameter : job.parameters)
    if (parameter.name != "scene" && parameter.name != "sample")
      overrides.push_back({scene_key(parameter.name), parameter.value});
  return load_scene(*subject_file(plan, text_of(value_of(job, "scene"))), default_assets(), overrides);
}

std::optional<fs::path> subject_file(const Plan& plan, const std::string& subject) {
  if (plan.mode == Mode::run || is_file_name(subject)) return plan.file.parent_path() / subject;
  const AssetPaths assets = default_assets();
  const auto catalogue = pipeline::detail::load_catalogue(assets.meshes);
  const auto known = catalogue.find(subject);
  if (known == catalogue.end()) return {};
  return assets.mesh_cache / known->second.file;
}

std::string text_of(const std::string& json) {
  return json.starts_with('"') ? nlohmann::json::parse(json).get<std::string>() : json;
}

}  // namespace sunder::batch::detail
