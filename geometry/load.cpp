#include "geometry/load.h"

#include <algorithm>
#include <exception>
#include <fstream>
#include <iomanip>
#include <limits>

#include <assimp/Importer.hpp>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include "core/error.h"
#include "geometry/detail/clean.h"

namespace sunder::geometry {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail(ErrorKind kind, const fs::path& file, const std::string& reason) {
  throw Error(kind, file.string() + ": " + reason);
}

Mat3 rotation_to_y_up(UpAxis up) {
  Mat3 rotation = Mat3::Identity();
  if (up == UpAxis::z) rotation << 1, 0, 0, 0, 0, 1, 0, -1, 0;
  if (up == UpAxis::x) rotation << 0, -1, 0, 1, 0, 0, 0, 0, 1;
  return rotation;
}

Vec3 transformed_point(const aiMatrix4x4& matrix, const aiVector3D& point) {
  const Vec3 x(point.x, point.y, point.z);
  return {Vec3(matrix.a1, matrix.a2, matrix.a3).dot(x) + matrix.a4,
          Vec3(matrix.b1, matrix.b2, matrix.b3).dot(x) + matrix.b4,
          Vec3(matrix.c1, matrix.c2, matrix.c3).dot(x) + matrix.c4};
}

void append_mesh(TriangleMesh& mesh, const aiMesh& part, const aiMatrix4x4& to_world) {
  const int first = static_cast<int>(mesh.vertices.size());
  for (unsigned i = 0; i < part.mNumVertices; ++i)
    mesh.vertices.push_back(transformed_point(to_world, part.mVertices[i]));
  const bool mirrored = to_world.Determinant() < 0;
  for (unsigned i = 0; i < part.mNumFaces; ++i) {
    const aiFace& face = part.mFaces[i];
    if (face.mNumIndices != 3) continue;  // points and lines
    const auto corner = [&](int at) { return first + static_cast<int>(face.mIndices[at]); };
    mesh.faces.push_back({corner(0), corner(mirrored ? 2 : 1), corner(mirrored ? 1 : 2)});
  }
}

void append_node(TriangleMesh& mesh, const aiScene& scene, const aiNode& node, const aiMatrix4x4& parent) {
  const aiMatrix4x4 to_world = parent * node.mTransformation;
  for (unsigned i = 0; i < node.mNumMeshes; ++i) append_mesh(mesh, *scene.mMeshes[node.mMeshes[i]], to_world);
  for (unsigned i = 0; i < node.mNumChildren; ++i) append_node(mesh, scene, *node.mChildren[i], to_world);
}

// assimp makes room for as many vertices and faces as the head of an OFF file promises before it looks for them.
void require_honest_off_header(const fs::path& file) {
  std::ifstream in(file);
  std::string magic;
  double vertices = 0, faces = 0;
  if (!(in >> magic >> vertices >> faces)) return;
  // Even the shortest vertex line ("0 0 0") and face line are longer than this many bytes.
  constexpr double kBytesPerLine = 4;
  if (kBytesPerLine * (vertices + faces) > static_cast<double>(fs::file_size(file))) {
    fail(ErrorKind::io, file, "is shorter than its header says");
  }
}

TriangleMesh read(const fs::path& file) {
  if (!fs::is_regular_file(file)) fail(ErrorKind::io, file, "no such file");
  if (file.extension() == ".off") require_honest_off_header(file);
  Assimp::Importer importer;
  // Only positions matter: without normals and texture coordinates vertices weld across seams.
  constexpr int kIgnored = aiComponent_NORMALS | aiComponent_TANGENTS_AND_BITANGENTS | aiComponent_COLORS |
                           aiComponent_TEXCOORDS | aiComponent_TEXTURES | aiComponent_MATERIALS | aiComponent_LIGHTS |
                           aiComponent_CAMERAS | aiComponent_ANIMATIONS | aiComponent_BONEWEIGHTS;
  importer.SetPropertyInteger(AI_CONFIG_PP_RVC_FLAGS, kIgnored);
  const aiScene* scene = nullptr;
  try {
    scene = importer.ReadFile(file.string(), aiProcess_Triangulate | aiProcess_RemoveComponent);
  } catch (const std::exception& error) {
    fail(ErrorKind::io, file, error.what());
  }
  if (scene == nullptr) fail(ErrorKind::io, file, importer.GetErrorString());
  TriangleMesh mesh;
  if (scene->mRootNode != nullptr) append_node(mesh, *scene, *scene->mRootNode, aiMatrix4x4());
  return mesh;
}

void write_obj(std::ostream& out, const TriangleMesh& mesh) {
  for (const Vec3& x : mesh.vertices) out << "v " << x.x() << ' ' << x.y() << ' ' << x.z() << '\n';
  for (const auto& [a, b, c] : mesh.faces) out << "f " << a + 1 << ' ' << b + 1 << ' ' << c + 1 << '\n';
}

void write_off(std::ostream& out, const TriangleMesh& mesh) {
  out << "OFF\n" << mesh.vertices.size() << ' ' << mesh.faces.size() << " 0\n";
  for (const Vec3& x : mesh.vertices) out << x.x() << ' ' << x.y() << ' ' << x.z() << '\n';
  for (const auto& [a, b, c] : mesh.faces) out << "3 " << a << ' ' << b << ' ' << c << '\n';
}

}  // namespace

TriangleMesh load_mesh(const fs::path& file, const LoadSettings& settings) {
  TriangleMesh mesh = read(file);
  if (mesh.faces.empty()) fail(ErrorKind::mesh, file, "holds no triangle");
  const int count = static_cast<int>(mesh.vertices.size());
  for (const auto& [a, b, c] : mesh.faces) {
    const bool exist = std::min({a, b, c}) >= 0 && std::max({a, b, c}) < count;
    if (!exist) fail(ErrorKind::mesh, file, "holds a face that names a vertex that does not exist");
  }
  for (const Vec3& vertex : mesh.vertices) {
    if (!vertex.allFinite()) fail(ErrorKind::mesh, file, "holds a vertex whose position is not a finite number");
  }
  mesh = detail::welded(mesh, 0);
  if (mesh.faces.empty()) fail(ErrorKind::mesh, file, "holds only triangles that have shrunk to a line or a point");
  return transformed(mesh, settings.metres_per_unit * rotation_to_y_up(settings.up), Vec3::Zero());
}

void save_mesh(const TriangleMesh& mesh, const fs::path& file) {
  const std::string extension = file.extension().string();
  if (extension != ".obj" && extension != ".off") fail(ErrorKind::io, file, "meshes are written as .off or .obj");
  std::ofstream out(file);
  out << std::setprecision(std::numeric_limits<double>::max_digits10);
  extension == ".obj" ? write_obj(out, mesh) : write_off(out, mesh);
  if (!out.flush()) fail(ErrorKind::io, file, "cannot be written");
}

}  // namespace sunder::geometry
