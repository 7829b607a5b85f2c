#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <limits>

#include "pipeline/detail/body_keys.h"
#include "pipeline/detail/effect_keys.h"
#include "pipeline/detail/material_keys.h"
#include "pipeline/detail/quality_words.h"
#include "pipeline/detail/scene_keys.h"
#include "pipeline/detail/scene_override.h"
#include "pipeline/scene.h"

namespace sunder::pipeline {
namespace detail {
namespace {

constexpr std::int64_t kMaximumCount = std::numeric_limits<int>::max();

void read_quality(const Value& value, Scene& scene) { scene.quality = read_quality_level(value); }

/// Seconds, or text such as "90 s", "5 min", "2 h".
void read_time_budget(const Value& value, Scene& scene) {
  if (!value.is_text()) {
    scene.time_budget = value.positive();
    return;
  }
  const auto seconds = duration_of(value.text());
  if (!seconds)
    value.fail("expected seconds, or a text such as \"90 s\", \"5 min\" or \"2 h\", found \"" + value.text() + "\"");
  scene.time_budget = *seconds;
}

void read_seed(const Value& value, Scene& scene) {
  scene.seed = read_seed_value(value);
}

constexpr std::array<Key<Scene>, 7> kSceneKeys = {{
    {"duration", [](const Value& value, Scene& scene) { scene.duration = value.positive(); }},
    {"frame_rate", [](const Value& value, Scene& scene) { scene.frame_rate = value.positive(); }},
    {"start_frame", [](const Value& value,
                       Scene& scene) { scene.start_frame = static_cast<int>(value.integer(0, kMaximumCount / 2)); }},
    {"seed", read_seed},
    {"gravity", [](const Value& value, Scene& scene) { scene.gravity = value.vector(); }},
    {"quality", read_quality},
    {"time_budget", read_time_budget},
}};

struct GroundDraft {
  Ground ground;
  const MaterialLibrary& materials;
};

constexpr std::array<Key<GroundDraft>, 2> kGroundKeys = {{
    {"height", [](const Value& value, GroundDraft& draft) { draft.ground.height = value.number(); }},
    {"material",
     [](const Value& value, GroundDraft& draft) { draft.ground.material = find_material(value, draft.materials); }},
}};

void read_damage(const Value& value, FractureSettings& settings) {
  constexpr std::array<std::pair<std::string_view, DamageModel>, 2> kModels = {
      {{"front", DamageModel::front}, {"local", DamageModel::local}}};
  settings.damage = value.word<DamageModel>(kModels);
}

void read_load(const Value& value, FractureSettings& settings) {
  constexpr std::array<std::pair<std::string_view, LoadModel>, 2> kModels = {
      {{"contact", LoadModel::contact}, {"prescribed", LoadModel::prescribed}}};
  settings.load = value.word<LoadModel>(kModels);
}

void read_spline(const Value& value, FractureSettings& settings) {
  constexpr std::array<std::pair<std::string_view, mpm::Spline>, 2> kSplines = {
      {{"quadratic", mpm::Spline::quadratic}, {"cubic", mpm::Spline::cubic}}};
  settings.spline = value.word<mpm::Spline>(kSplines);
}

void read_cut(const Value& value, FractureSettings& settings) {
  constexpr std::array<std::pair<std::string_view, bool>, 2> kWays = {{{"exact", false}, {"level_set", true}}};
  settings.level_set_cut = value.word<bool>(kWays);
}

constexpr std::array<Key<FractureSettings>, 14> kFractureKeys = {{
    {"minimum_impulse",
     [](const Value& value, FractureSettings& settings) { settings.minimum_impulse = value.non_negative(); }},
    {"minimum_volume",
     [](const Value& value, FractureSettings& settings) { settings.minimum_volume = value.within(0, 1); }},
    {"maximum_fractures",
     [](const Value& value, FractureSettings& settings) {
       settings.maximum_fractures = static_cast<int>(value.integer(0, kMaximumCount));
     }},
    {"refracture_delay",
     [](const Value& value, FractureSettings& settings) { settings.refracture_delay = value.non_negative(); }},
    {"maximum_fragments",
     [](const Value& value, FractureSettings& settings) {
       settings.maximum_fragments = static_cast<int>(value.integer(0, kMaximumCount));
     }},
    {"tiny_volume", [](const Value& value, FractureSettings& settings) { settings.tiny_volume = value.within(0, 1); }},
    {"small_volume",
     [](const Value& value, FractureSettings& settings) { settings.small_volume = value.within(0, 1); }},
    {"nearly_whole_volume",
     [](const Value& value, FractureSettings& settings) { settings.nearly_whole_volume = value.within(0, 1); }},
    {"damage", read_damage},
    {"load", read_load},
    {"spline", read_spline},
    {"node_spacing", [](const Value& value, FractureSettings& settings) { settings.node_spacing = value.positive(); }},
    {"cut", read_cut},
    {"voxel_size", [](const Value& value, FractureSettings& settings) { settings.voxel_size = value.positive(); }},
}};

template <bool Outputs::*format>
void read_format(const Value& value, Outputs& outputs) {
  outputs.*format = value.flag();
}

void read_transforms(const Value& value, Outputs& outputs) {
  using enum TransformTable;
  constexpr std::array<std::pair<std::string_view, TransformTable>, 4> kTables = {
      {{"off", off}, {"csv", csv}, {"jsonl", jsonl}, {"both", both}}};
  outputs.transforms = value.word<TransformTable>(kTables);
}

constexpr std::array<Key<Outputs>, 11> kOutputKeys = {{
    {"obj", read_format<&Outputs::obj>},
    {"ply", read_format<&Outputs::ply>},
    {"glb", read_format<&Outputs::glb>},
    {"usd", read_format<&Outputs::usd>},
    {"transforms", read_transforms},
    {"fragments_csv", read_format<&Outputs::fragments_csv>},
    {"vdb", read_format<&Outputs::vdb>},
    {"page", read_format<&Outputs::page>},
    {"poster", read_format<&Outputs::poster>},
    {"blender", read_format<&Outputs::blender>},
    {"checkpoint_interval",
     [](const Value& value, Outputs& outputs) {
       outputs.checkpoint_interval = static_cast<int>(value.integer(0, kMaximumCount));
     }},
}};

const std::vector<std::string>& top_level_keys() {
  static const std::vector<std::string> keys = {"scene", "ground", "material", "body", "fracture", "effects", "output"};
  return keys;
}

std::string bracketed(std::string_view name) { return std::string("[").append(name).append("]"); }

// Null when the scene has no such section.
const toml::table* find_table(const std::filesystem::path& file, const toml::table& document, std::string_view name) {
  const toml::node* node = document.get(name);
  if (!node) return nullptr;
  if (!node->is_table()) {
    fail(file, static_cast<int>(node->source().begin.line), "expected a section " + bracketed(name));
  }
  return node->as_table();
}

template <class Target>
void read_optional(const std::filesystem::path& file, const toml::table& document, std::string_view name,
                   std::span<const Key<Target>> keys, Target& target) {
  const toml::table* table = find_table(file, document, name);
  if (table) read_section<Target>({file, *table, bracketed(name)}, keys, target);
}

std::vector<std::string> scene_material_keys() {
  std::vector<std::string> keys = key_names(material_keys());
  keys.insert(keys.begin(), "base");
  return keys;
}

Material read_material(const Section& section, const MaterialLibrary& presets) {
  check_keys(section, scene_material_keys());
  Material material;
  const toml::node* base = section.table.get("base");
  if (base) {
    material = find_material(Value(section.file, *base, section.name + ": base"), presets);
    material.source = "as " + material.name + ", with values of " + section.file.filename().string();
  } else {
    material.source = section.file.filename().string();
  }
  read_keys(section, material_keys(), material);
  check_complete(section, material);
  return material;
}

// The presets and the scene's own materials; the latter win.
MaterialLibrary read_materials(const std::filesystem::path& file, const toml::table& document,
                               const MaterialLibrary& presets) {
  MaterialLibrary library = presets;
  const toml::table* sections = find_table(file, document, "material");
  if (!sections) return library;
  for (const auto& [key, node] : *sections) {
    const int line = static_cast<int>(key.source().begin.line);
    const std::string name(key.str());
    check_name(file, line, name);
    if (!node.is_table()) fail(file, line, "a material has a name: [material.<name>]");
    library[name] = read_material({file, *node.as_table(), "material '" + name + "'"}, presets);
    library[name].name = name;
  }
  return library;
}

EffectSettings read_effects(const std::filesystem::path& file, const toml::table& document) {
  EffectSettings settings;
  read_optional<EffectSettings>(file, document, "effects", effect_keys(), settings);
  if (const toml::table* table = find_table(file, document, "effects"))
    check_effects({file, *table, bracketed("effects")}, settings);
  return settings;
}

std::optional<Ground> read_ground(const std::filesystem::path& file, const toml::table& document,
                                  const MaterialLibrary& materials) {
  if (!document.contains("ground")) return std::nullopt;
  GroundDraft draft{.ground = {.height = 0, .material = materials.at("stone")}, .materials = materials};
  read_optional<GroundDraft>(file, document, "ground", kGroundKeys, draft);
  return draft.ground;
}

void check_unique_name(const std::filesystem::path& file, const std::vector<SceneBody>& bodies, const SceneBody& body) {
  for (const SceneBody& other : bodies) {
    if (other.name != body.name) continue;
    fail(file, body.line,
         "body name '" + body.name + "' is taken: line " + std::to_string(other.line) + " has a body of this name");
  }
}

std::vector<SceneBody> read_bodies(const std::filesystem::path& file, const toml::table& document, const Names& names) {
  const toml::node* node = document.get("body");
  if (!node) fail(file, 1, "the scene has no body; add a section [[body]]");
  const int line = static_cast<int>(node->source().begin.line);
  if (!node->is_array_of_tables()) fail(file, line, "a body is a section [[body]], with two brackets");
  std::vector<SceneBody> bodies;
  for (const toml::node& entry : *node->as_array()) {
    const SceneBody body = read_body(file, *entry.as_table(), names);
    check_unique_name(file, bodies, body);
    bodies.push_back(body);
  }
  return bodies;
}

void check_volumes(const std::filesystem::path& file, const toml::table& document, const FractureSettings& settings) {
  const toml::table* table = find_table(file, document, "fracture");
  if (!table) return;
  const Section section{file, *table, "[fracture]"};
  if (settings.small_volume < settings.tiny_volume) {
    if (section.has("small_volume")) section.fail_at("small_volume", "small_volume: has to be at least tiny_volume");
    section.fail_at("tiny_volume", "tiny_volume: has to be at most small_volume");
  }
  if (settings.nearly_whole_volume < settings.small_volume)
    section.fail_at("nearly_whole_volume", "nearly_whole_volume: has to be at least small_volume");
}

void check_budget(const std::filesystem::path& file, const toml::table& document) {
  const toml::table* table = find_table(file, document, "scene");
  if (!table) return;
  const Section section{file, *table, "[scene]"};
  if (section.has("time_budget") && section.has("quality"))
    section.fail_at("time_budget", "time_budget: chooses the quality; leave out quality, or time_budget");
}

void check_frame_count(const std::filesystem::path& file, const toml::table& document, const Scene& scene) {
  constexpr double kMaximumFrames = 1e6;  // more is a slip of the pen, and would fill any disk
  if (scene.duration * scene.frame_rate <= kMaximumFrames) return;
  const toml::table* table = find_table(file, document, "scene");
  fail(file, table ? static_cast<int>(table->source().begin.line) : 1,
       "[scene]: duration times frame_rate gives more than a million frames");
}

}  // namespace

std::vector<SectionKeys> scene_keys() {
  return {{"[scene]", key_names<Scene>(kSceneKeys)},
          {"[ground]", key_names<GroundDraft>(kGroundKeys)},
          {"[material.<name>]", scene_material_keys()},
          {"[[body]]", key_names(body_keys())},
          {"[fracture]", key_names<FractureSettings>(kFractureKeys)},
          {"[effects]", key_names(effect_keys())},
          {"[output]", key_names<Outputs>(kOutputKeys)}};
}

}  // namespace detail

int last_frame(const Scene& scene) {
  const int last = scene.start_frame + static_cast<int>(std::floor(scene.duration * scene.frame_rate + 1e-9));
  return std::min(last, scene.outputs.last_frame.value_or(last));
}

AssetPaths default_assets() {
  const auto folder = [](const char* variable, const char* otherwise) {
    const char* value = std::getenv(variable);
    return std::filesystem::path(value && *value ? value : otherwise);
  };
  const std::filesystem::path assets = folder("SUNDER_ASSETS", SUNDER_SOURCE_DIR "/assets");
  return {.materials = assets / "materials.toml",
          .meshes = assets / "meshes.toml",
          .mesh_cache = folder("SUNDER_MESHES", SUNDER_SOURCE_DIR "/build/meshes")};
}

namespace {

Scene read_scene(const std::filesystem::path& file, const toml::table& document, const AssetPaths& assets) {
  using namespace detail;
  check_keys({file, document, "scene"}, top_level_keys());
  Scene scene;
  scene.file = file;
  scene.name = file.stem().string();
  read_optional<Scene>(file, document, "scene", kSceneKeys, scene);
  check_frame_count(file, document, scene);
  check_budget(file, document);
  const Names names{.mesh_cache = assets.mesh_cache,
                    .meshes = load_catalogue(assets.meshes),
                    .materials = read_materials(file, document, load_materials(assets.materials))};
  scene.ground = read_ground(file, document, names.materials);
  scene.bodies = read_bodies(file, document, names);
  read_optional<FractureSettings>(file, document, "fracture", kFractureKeys, scene.fracture);
  check_volumes(file, document, scene.fracture);
  scene.effects = read_effects(file, document);
  read_optional<Outputs>(file, document, "output", kOutputKeys, scene.outputs);
  return scene;
}

}  // namespace

Scene load_scene(const std::filesystem::path& file, const AssetPaths& assets, const std::vector<Override>& overrides) {
  toml::table document = detail::parse_file(file);
  if (overrides.empty()) return read_scene(file, document, assets);
  std::string list;
  for (const Override& change : overrides) {
    detail::apply(change, file, document);
    list.append(list.empty() ? "" : ", ").append(change.key).append(" = ").append(change.value);
  }
  try {
    Scene scene = read_scene(file, document, assets);
    scene.overrides = overrides;
    return scene;
  } catch (const Error& error) {
    throw Error(error.kind(), std::string(error.what()) + " (with " + list + ")");
  }
}

}  // namespace sunder::pipeline
