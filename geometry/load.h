#pragma once
/// Reading mesh files.
#include <filesystem>
#include <optional>
#include <string>

#include "geometry/attributes.h"
#include "geometry/mesh.h"

namespace sunder::geometry {

enum class UpAxis { x, y, z };

struct LoadSettings {
  /// Length of one unit of the file [m]; not set: what the file states (FBX), otherwise a metre.
  std::optional<double> metres_per_unit;
  /// The file's up axis; the result is Y-up, handedness kept. Not set: what the file states (FBX), otherwise Y.
  std::optional<UpAxis> up;
  std::string part;  ///< only the mesh or node of this name, with all below it; empty: all
};

/// Reads any format that assimp reads; all meshes of the file become one, or those of one part, node transforms
/// applied (collada and glTF files say their unit and axis in them), polygons triangulated and coincident vertices
/// welded (bit-equal positions only: `repair` does more). Skinned and animated meshes come as they are stored. Errors:
/// ErrorKind::io when the file is missing or unreadable (with assimp's reason), ErrorKind::mesh when it holds no
/// triangle, a position that is not finite or no part of the name (the message lists those that it has).
TriangleMesh load_mesh(const std::filesystem::path& file, const LoadSettings& settings = {});

struct TexturedMesh {
  TriangleMesh mesh;
  SurfaceAttributes attributes;
  double metres_per_unit = 1;  ///< that was used [m]
  UpAxis up = UpAxis::y;       ///< that was used
};

/// The same mesh with what its surface carries: the first set of texture coordinates, normals (turned with node
/// transforms and axes, unit length), the first set of vertex colours and materials with their names, as far as the
/// file has them. Where only parts of a file have texture coordinates, normals or colours, the others get (0, 0), the
/// normals of their faces and white. Materials are numbered as in the file, those that no face uses left out; a file
/// without materials has none. Errors: as load_mesh.
TexturedMesh load_textured_mesh(const std::filesystem::path& file, const LoadSettings& settings = {});

/// Writes a binary-exact (17 digits) OFF or OBJ by extension; for tests and for looking. Errors: ErrorKind::io.
void save_mesh(const TriangleMesh& mesh, const std::filesystem::path& file);

}  // namespace sunder::geometry
