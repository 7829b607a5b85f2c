#pragma once
/// Meshes by short name (assets/meshes.toml).
#include <filesystem>
#include <map>
#include <string>

#include "geometry/load.h"

namespace sunder::pipeline::detail {

struct CatalogueMesh {
  std::filesystem::path file;  ///< relative to the mesh cache
  geometry::UpAxis up = geometry::UpAxis::y;
  std::string about;
};

using MeshCatalogue = std::map<std::string, CatalogueMesh>;

/// Errors: ErrorKind::usage with file and line.
MeshCatalogue load_catalogue(const std::filesystem::path& file);

}  // namespace sunder::pipeline::detail
