#pragma once
/// What a [[body]] section holds.
#include <optional>

#include "pipeline/detail/mesh_catalogue.h"
#include "pipeline/detail/primitive_shapes.h"
#include "pipeline/detail/toml_reader.h"
#include "pipeline/scene.h"

namespace sunder::pipeline::detail {

/// What the names in a body refer to.
struct Names {
  std::filesystem::path mesh_cache;
  MeshCatalogue meshes;
  MaterialLibrary materials;  ///< presets and the scene's own
};

/// A body while it is read.
struct BodyDraft {
  SceneBody body;
  const Names& names;
  const PrimitiveShape* primitive = nullptr;
  bool from_catalogue = false;

  bool from_file() const { return !primitive && !from_catalogue; }
};

std::span<const Key<BodyDraft>> body_keys();

/// Reads one body. Errors: ErrorKind::usage with file and line.
SceneBody read_body(const std::filesystem::path& file, const toml::table& table, const Names& names);

/// Reads a name that may stand in object and file names: letters, digits, '_', '-'.
std::string read_name(const Value& value);
void check_name(const std::filesystem::path& file, int line, std::string_view name);

/// The material called so. Fails with the nearest name.
const Material& find_material(const Value& value, const MaterialLibrary& materials);

}  // namespace sunder::pipeline::detail
