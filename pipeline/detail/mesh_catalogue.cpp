#include "pipeline/detail/mesh_catalogue.h"

#include <array>

#include "pipeline/detail/mesh_words.h"

namespace sunder::pipeline::detail {
namespace {

constexpr std::array<Key<CatalogueMesh>, 3> kKeys = {{
    {"file", [](const Value& value, CatalogueMesh& mesh) { mesh.file = value.text(); }, true},
    {"up", [](const Value& value, CatalogueMesh& mesh) { mesh.up = read_up_axis(value); }, true},
    {"about", [](const Value& value, CatalogueMesh& mesh) { mesh.about = value.text(); }},
}};

}  // namespace

MeshCatalogue load_catalogue(const std::filesystem::path& file) {
  const toml::table document = parse_file(file);
  MeshCatalogue catalogue;
  for (const auto& [key, node] : document) {
    const std::string name(key.str());
    const toml::table* table = node.as_table();
    if (!table) fail(file, static_cast<int>(key.source().begin.line), "'" + name + "' is not a [section]");
    CatalogueMesh mesh;
    read_section<CatalogueMesh>({file, *table, "mesh '" + name + "'"}, kKeys, mesh);
    catalogue.emplace(name, mesh);
  }
  return catalogue;
}

}  // namespace sunder::pipeline::detail
