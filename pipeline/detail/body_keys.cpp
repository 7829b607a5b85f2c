#include "pipeline/detail/body_keys.h"

#include <algorithm>
#include <array>
#include <numbers>
#include <system_error>

#include "pipeline/detail/mesh_words.h"

namespace sunder::pipeline::detail {
namespace {

namespace fs = std::filesystem;

std::vector<std::string> mesh_names(const MeshCatalogue& catalogue) {
  std::vector<std::string> names;
  for (const PrimitiveShape& shape : primitive_shapes()) names.emplace_back(shape.name);
  for (const auto& [name, mesh] : catalogue) names.push_back(name);
  return names;
}

bool is_file(const fs::path& file) {
  std::error_code ignored;
  return fs::is_regular_file(file, ignored);
}

void choose_catalogue_mesh(const Value& value, const CatalogueMesh& mesh, BodyDraft& draft) {
  draft.from_catalogue = true;
  MeshChoice& choice = draft.body.mesh;
  choice.file = draft.names.mesh_cache / mesh.file;
  choice.load.up = mesh.up;
  if (!is_file(choice.file)) {
    value.fail("the file of mesh '" + choice.name + "' is missing: " + choice.file.string() +
               "; run ./sunder once, which unpacks the meshes, or set SUNDER_MESHES to their folder");
  }
}

void choose_mesh_file(const Value& value, BodyDraft& draft) {
  MeshChoice& choice = draft.body.mesh;
  // A bare word can only be a name that nobody knows.
  if (choice.name.find_first_of("./") == std::string::npos) {
    value.fail("unknown mesh '" + choice.name + "'" + suggestion(choice.name, mesh_names(draft.names.meshes)));
  }
  choice.file = value.file().parent_path() / choice.name;
  if (!is_file(choice.file)) value.fail("there is no mesh file " + choice.file.string());
}

void read_mesh(const Value& value, BodyDraft& draft) {
  MeshChoice& choice = draft.body.mesh;
  choice.name = value.text();
  draft.primitive = find_primitive(choice.name);
  if (draft.primitive) return;
  const auto mesh = draft.names.meshes.find(choice.name);
  if (mesh != draft.names.meshes.end()) return choose_catalogue_mesh(value, mesh->second, draft);
  choose_mesh_file(value, draft);
}

void read_unit(const Value& value, BodyDraft& draft) {
  if (!draft.from_file()) value.fail("only a mesh file has a unit; mesh '" + draft.body.mesh.name + "' has none");
  draft.body.mesh.load.metres_per_unit = read_unit_length(value);
}

void read_up(const Value& value, BodyDraft& draft) {
  if (!draft.from_file()) value.fail("the up axis of mesh '" + draft.body.mesh.name + "' is known");
  draft.body.mesh.load.up = read_up_axis(value);
}

void read_size(const Value& value, BodyDraft& draft) {
  if (draft.primitive && !draft.primitive->by_size) {
    value.fail("mesh '" + draft.body.mesh.name + "' takes 'height' instead");
  }
  draft.body.mesh.size = value.positive_vector();
}

void read_height(const Value& value, BodyDraft& draft) {
  if (draft.primitive && !draft.primitive->by_height) {
    value.fail("mesh '" + draft.body.mesh.name + "' takes 'size' instead");
  }
  draft.body.mesh.height = value.positive();
}

void read_wall(const Value& value, BodyDraft& draft) {
  if (!draft.primitive || draft.primitive->wall_share == 0) {
    value.fail("mesh '" + draft.body.mesh.name + "' has no wall thickness to set");
  }
  draft.body.mesh.wall = value.positive();
}

void read_repair(const Value& value, BodyDraft& draft) {
  constexpr std::array<std::pair<std::string_view, RepairMode>, 3> kModes = {
      {{"auto", RepairMode::automatic}, {"off", RepairMode::off}, {"remesh", RepairMode::remesh}}};
  draft.body.mesh.repair = value.word<RepairMode>(kModes);
}

void read_remesh_voxel(const Value& value, BodyDraft& draft) {
  if (!draft.from_file()) value.fail("mesh '" + draft.body.mesh.name + "' is made by the program and never remeshed");
  if (draft.body.mesh.repair == RepairMode::off) value.fail("with repair = \"off\" nothing is remeshed");
  draft.body.mesh.remesh_voxel = value.positive();
}

void read_part(const Value& value, BodyDraft& draft) {
  if (!draft.from_file()) value.fail("only a mesh file has parts; mesh '" + draft.body.mesh.name + "' has none");
  draft.body.mesh.load.part = value.text();
}

void read_anchor(const Value& value, BodyDraft& draft) {
  constexpr std::array<std::pair<std::string_view, Anchor>, 3> kAnchors = {
      {{"base", Anchor::base}, {"centre", Anchor::centre}, {"origin", Anchor::origin}}};
  draft.body.anchor = value.word<Anchor>(kAnchors);
}

// Turns about the fixed world axes X, then Y, then Z.
Quat rotation_of(const Value& value) {
  const Vec3 angles = value.vector() * (std::numbers::pi / 180);
  return Eigen::AngleAxisd(angles.z(), Vec3::UnitZ()) * Eigen::AngleAxisd(angles.y(), Vec3::UnitY()) *
         Eigen::AngleAxisd(angles.x(), Vec3::UnitX());
}

constexpr std::array<Key<Keyframe>, 3> kKeyframeKeys = {{
    {"time", [](const Value& value, Keyframe& keyframe) { keyframe.time = value.non_negative(); }, true},
    {"position", [](const Value& value, Keyframe& keyframe) { keyframe.pose.position = value.vector(); }, true},
    {"rotation", [](const Value& value, Keyframe& keyframe) { keyframe.pose.orientation = rotation_of(value); }},
}};

// The first keyframe is where the body starts, so no time may be left over before it.
void read_path(const Value& value, BodyDraft& draft) {
  if (draft.body.motion != rigid::Motion::kinematic)
    value.fail("only a body with motion = \"kinematic\" follows a path");
  MotionPath& path = draft.body.path;
  for (const Section& section : value.tables()) {
    Keyframe keyframe;
    if (!path.empty()) keyframe.pose.orientation = path.back().pose.orientation;
    read_section<Keyframe>(section, kKeyframeKeys, keyframe);
    if (path.empty() && keyframe.time > 0)
      section.fail("the path has a gap before its first keyframe; where the body starts has time = 0");
    if (!path.empty() && !(keyframe.time > path.back().time))
      section.fail("its time has to be later than that of the keyframe before");
    path.push_back(keyframe);
  }
  if (path.size() < 2) value.fail("a path has at least two keyframes");
  draft.body.position = path.front().pose.position;
  draft.body.orientation = path.front().pose.orientation;
}

void read_material(const Value& value, BodyDraft& draft) {
  draft.body.material = find_material(value, draft.names.materials);
  draft.body.breakable = draft.body.material.breakable;
}

void read_breakable(const Value& value, BodyDraft& draft) {
  draft.body.breakable = value.flag();
  if (draft.body.breakable && !draft.body.material.breakable) {
    value.fail("material '" + draft.body.material.name + "' does not break; take another, or none");
  }
}

void read_motion(const Value& value, BodyDraft& draft) {
  using rigid::Motion;
  constexpr std::array<std::pair<std::string_view, Motion>, 3> kMotions = {
      {{"dynamic", Motion::dynamic}, {"fixed", Motion::fixed}, {"kinematic", Motion::kinematic}}};
  draft.body.motion = value.word<Motion>(kMotions);
  const bool moves = !draft.body.velocity.isZero(0) || !draft.body.angular_velocity.isZero(0);
  if (draft.body.motion == Motion::fixed && moves) value.fail("a fixed body cannot have a velocity");
}

constexpr std::array<Key<BodyDraft>, 20> kBodyKeys = {{
    {"name", [](const Value& value, BodyDraft& draft) { draft.body.name = read_name(value); }, true},
    {"mesh", read_mesh, true},
    {"unit", read_unit},
    {"up", read_up},
    {"size", read_size},
    {"height", read_height},
    {"wall", read_wall},
    {"part", read_part},
    {"repair", read_repair},
    {"remesh_voxel", read_remesh_voxel},
    {"anchor", read_anchor},
    {"position", [](const Value& value, BodyDraft& draft) { draft.body.position = value.vector(); }},
    {"rotation", [](const Value& value, BodyDraft& draft) { draft.body.orientation = rotation_of(value); }},
    {"velocity", [](const Value& value, BodyDraft& draft) { draft.body.velocity = value.vector(); }},
    {"angular_velocity", [](const Value& value, BodyDraft& draft) { draft.body.angular_velocity = value.vector(); }},
    {"motion", read_motion},
    {"path", read_path},
    {"material", read_material, true},
    {"breakable", read_breakable},
    {"minimum_impulse",
     [](const Value& value, BodyDraft& draft) { draft.body.minimum_impulse = value.non_negative(); }},
}};

// Exactly one of size and height where a mesh has no size of its own; a mesh file may go without either.
void check_dimensions(const Section& section, const BodyDraft& draft) {
  const bool sized = section.has("size"), high = section.has("height");
  if (sized && high) section.fail_at("height", "give 'size' or 'height', not both");
  if (sized || high || draft.from_file()) return;
  const bool wants_size = draft.primitive && !draft.primitive->by_height;
  section.fail_at("mesh", "mesh '" + draft.body.mesh.name + "' needs a " + (wants_size ? "'size'" : "'height'"));
}

// A path says where the body is and how it moves.
void check_path(const Section& section) {
  for (const char* key : {"position", "rotation", "velocity", "angular_velocity"})
    if (section.has("path") && section.has(key))
      section.fail_at(key, std::string("give '") + key + "' or 'path', not both");
}

// Generating a primitive is the one sure test of its dimensions, and takes no time.
void check_primitive(const Section& section, const BodyDraft& draft) {
  try {
    make_primitive(*draft.primitive, draft.body.mesh);
  } catch (const Error& error) {
    section.fail_at(section.has("wall") ? "wall" : "mesh", error.what());
  }
}

std::string section_name(const toml::table& table) {
  const auto name = table["name"].value<std::string>();
  return name ? "body '" + *name + "'" : "[[body]]";
}

}  // namespace

void check_name(const std::filesystem::path& file, int line, std::string_view name) {
  const auto allowed = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '-';
  };
  if (std::all_of(name.begin(), name.end(), allowed)) return;
  fail(file, line, "the name '" + std::string(name) + "' may have letters, digits, '_' and '-' only");
}

std::string read_name(const Value& value) {
  const std::string name = value.text();
  check_name(value.file(), value.line(), name);
  return name;
}

const Material& find_material(const Value& value, const MaterialLibrary& materials) {
  const std::string name = value.text();
  if (const auto found = materials.find(name); found != materials.end()) return found->second;
  std::vector<std::string> names;
  for (const auto& [known, material] : materials) names.push_back(known);
  value.fail("unknown material '" + name + "'" + suggestion(name, names));
}

std::span<const Key<BodyDraft>> body_keys() { return kBodyKeys; }

SceneBody read_body(const std::filesystem::path& file, const toml::table& table, const Names& names) {
  const Section section{file, table, section_name(table)};
  BodyDraft draft{.body = {}, .names = names};
  read_section(section, body_keys(), draft);
  check_dimensions(section, draft);
  check_path(section);
  if (draft.primitive) check_primitive(section, draft);
  draft.body.line = section.line();
  return draft.body;
}

}  // namespace sunder::pipeline::detail
