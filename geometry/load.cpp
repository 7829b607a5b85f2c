#include "geometry/load.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <exception>
#include <fstream>
#include <iomanip>
#include <limits>
#include <set>
#include <system_error>
#include <utility>

#include <assimp/Importer.hpp>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include "core/child_process.h"
#include "core/error.h"
#include "geometry/detail/clean.h"
#include "geometry/detail/packed_mesh.h"

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

Mat3 linear_part(const aiMatrix4x4& m) {
  Mat3 result;
  result << m.a1, m.a2, m.a3, m.b1, m.b2, m.b3, m.c1, m.c2, m.c3;
  return result;
}

Vec3 to_vec3(const aiVector3D& x) { return {x.x, x.y, x.z}; }

Colour to_colour(const aiColor4D& c) {
  const Colour colour(c.r, c.g, c.b, c.a);
  return colour.allFinite() ? Colour(colour.cwiseMax(0).cwiseMin(1)) : Colour(Colour::Ones());
}

Vec3 unit_or_zero(const Vec3& x) {
  const double length = x.norm();
  return std::isfinite(length) && length > 0 ? Vec3(x / length) : Vec3(Vec3::Zero());
}

bool is_utf8(std::string_view text) {
  for (std::size_t i = 0; i < text.size();) {
    const auto byte = static_cast<unsigned char>(text[i]);
    const std::size_t length = byte < 0x80 ? 1 : byte >> 5 == 6 ? 2 : byte >> 4 == 14 ? 3 : byte >> 3 == 30 ? 4 : 0;
    if (length == 0 || i + length > text.size()) return false;
    for (std::size_t k = 1; k < length; ++k)
      if (static_cast<unsigned char>(text[i + k]) >> 6 != 2) return false;
    i += length;
  }
  return true;
}

// Names go into files of many formats: control characters, and bytes of other encodings than UTF-8, become underscores.
std::string clean_name(std::string name) {
  const bool utf8 = is_utf8(name);
  for (char& c : name) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte < 0x20 || byte == 0x7f || (byte >= 0x80 && !utf8)) c = '_';
  }
  return name;
}

/// All meshes of a scene as one.
class Collector {
 public:
  Collector(const fs::path& file, const aiScene& scene, const std::string& part)
      : file_(file), scene_(scene), part_(part) {
    if (scene.mRootNode != nullptr) append_node(*scene.mRootNode, aiMatrix4x4(), part.empty());
    if (!part.empty() && result_.mesh.faces.empty()) fail_part();
    if (!any_uv_) result_.attributes.uv.clear();
    if (!any_normal_) result_.attributes.normal.clear();
    if (!any_colour_) result_.attributes.colour.clear();
    name_materials();
  }

  /// Where normals are zero the file has none.
  TexturedMesh take() { return std::move(result_); }

 private:
  void append_node(const aiNode& node, const aiMatrix4x4& parent, bool wanted) {
    const aiMatrix4x4 to_world = parent * node.mTransformation;
    wanted = wanted || part_ == node.mName.C_Str();
    for (unsigned i = 0; node.mMeshes != nullptr && i < node.mNumMeshes; ++i) {
      if (node.mMeshes[i] >= scene_.mNumMeshes) fail(ErrorKind::mesh, file_, "names a mesh that it does not hold");
      const aiMesh& mesh = *scene_.mMeshes[node.mMeshes[i]];
      if (wanted || part_ == mesh.mName.C_Str()) append_mesh(mesh, to_world);
      for (const aiString* name : {&node.mName, &mesh.mName}) {
        if (name->length > 0) names_.insert(name->C_Str());
      }
    }
    for (unsigned i = 0; i < node.mNumChildren; ++i) {
      if (node.mChildren[i] != nullptr) append_node(*node.mChildren[i], to_world, wanted);
    }
  }

  [[noreturn]] void fail_part() const {
    constexpr std::size_t kListed = 20;
    std::string known;
    std::size_t count = 0;
    for (const std::string& name : names_) {
      if (count++ < kListed) known.append(count > 1 ? ", '" : "'").append(name).append("'");
    }
    if (count > kListed) known.append(" and ").append(std::to_string(count - kListed)).append(" more");
    fail(ErrorKind::mesh, file_,
         "holds no part '" + part_ + "' with triangles; " +
             (known.empty() ? "its parts have no names" : "it has " + known));
  }

  void append_mesh(const aiMesh& part, const aiMatrix4x4& to_world) {
    if (part.mVertices == nullptr || part.mFaces == nullptr) return;
    const Mat3 linear = linear_part(to_world);
    const Vec3 offset(to_world.a4, to_world.b4, to_world.c4);
    const int first = static_cast<int>(result_.mesh.vertices.size());
    for (unsigned i = 0; i < part.mNumVertices; ++i) {
      result_.mesh.vertices.push_back(linear * to_vec3(part.mVertices[i]) + offset);
    }
    any_uv_ |= part.HasTextureCoords(0);
    any_normal_ |= part.HasNormals();
    any_colour_ |= part.HasVertexColors(0);
    const double determinant = linear.determinant();
    const Mat3 of_normals = determinant != 0 ? Mat3(linear.inverse().transpose()) : Mat3(Mat3::Zero());
    for (unsigned i = 0; i < part.mNumFaces; ++i) {
      const aiFace& face = part.mFaces[i];
      if (face.mNumIndices != 3) continue;  // points and lines
      std::array<unsigned, 3> corner = {face.mIndices[0], face.mIndices[1], face.mIndices[2]};
      if (std::max({corner[0], corner[1], corner[2]}) >= part.mNumVertices) {
        fail(ErrorKind::mesh, file_, "holds a face that names a vertex that does not exist");
      }
      if (determinant < 0) std::swap(corner[1], corner[2]);
      append_face(part, corner, first, of_normals);
    }
  }

  void append_face(const aiMesh& part, const std::array<unsigned, 3>& corner, int first, const Mat3& of_normals) {
    Triangle face;
    std::array<Uv, 3> uv;
    std::array<Vec3, 3> normal;
    std::array<Colour, 3> colour;
    for (int k = 0; k < 3; ++k) {
      face[k] = first + static_cast<int>(corner[k]);
      uv[k].setZero();
      normal[k].setZero();
      colour[k] = part.HasVertexColors(0) ? to_colour(part.mColors[0][corner[k]]) : Colour(Colour::Ones());
      if (part.HasTextureCoords(0)) uv[k] = to_vec3(part.mTextureCoords[0][corner[k]]).head<2>();
      if (!uv[k].allFinite()) uv[k].setZero();
      if (part.HasNormals()) normal[k] = unit_or_zero(of_normals * to_vec3(part.mNormals[corner[k]]));
    }
    result_.mesh.faces.push_back(face);
    result_.attributes.uv.push_back(uv);
    result_.attributes.normal.push_back(normal);
    result_.attributes.colour.push_back(colour);
    result_.attributes.material.push_back(static_cast<int>(part.mMaterialIndex));
  }

  void name_materials() {
    SurfaceAttributes& attributes = result_.attributes;
    std::vector<int> number(scene_.mNumMaterials, -1);
    for (const int material : attributes.material) {
      if (material < static_cast<int>(number.size())) number[material] = 0;
    }
    for (unsigned i = 0; i < number.size(); ++i) {
      if (number[i] < 0) continue;
      number[i] = static_cast<int>(attributes.material_names.size());
      attributes.material_names.push_back(clean_name(scene_.mMaterials[i]->GetName().C_Str()));
    }
    // What assimp makes up where a file has no materials.
    const std::vector<std::string>& names = attributes.material_names;
    if (names.empty() || (names.size() == 1 && (names[0].empty() || names[0] == AI_DEFAULT_MATERIAL_NAME))) {
      attributes.material.clear();
      attributes.material_names.clear();
    }
    for (int& material : attributes.material) {
      material = material < static_cast<int>(number.size()) ? number[material] : 0;
    }
  }

  const fs::path& file_;
  const aiScene& scene_;
  const std::string& part_;
  std::set<std::string> names_;  // of nodes with meshes, and of meshes
  TexturedMesh result_;
  bool any_uv_ = false, any_normal_ = false, any_colour_ = false;
};

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

// Without the end of its header assimp reads a PLY file on and on.
void require_ply_header_end(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::string line;
  if (!std::getline(in, line) || !line.starts_with("ply")) return;
  while (std::getline(in, line)) {
    const std::size_t last = line.find_last_not_of(" \t\r");
    if (line.substr(0, last + 1) == "end_header") return;
  }
  fail(ErrorKind::io, file, "the header has no line \"end_header\"");
}

// What a file says of itself. FBX counts in units of so many centimetres; assimp applies neither unit nor axis of it.
struct Stated {
  std::optional<double> metres_per_unit;
  std::optional<UpAxis> up;
};

Stated stated_by(const aiScene& scene) {
  Stated stated;
  if (scene.mMetaData == nullptr) return stated;
  double centimetres = 0;
  float single = 0;
  if (!scene.mMetaData->Get("UnitScaleFactor", centimetres) && scene.mMetaData->Get("UnitScaleFactor", single))
    centimetres = single;
  if (std::isfinite(centimetres) && centimetres > 0) stated.metres_per_unit = centimetres / 100;
  std::int32_t axis = -1;
  if (scene.mMetaData->Get("UpAxis", axis) && axis >= 0 && axis <= 2)
    stated.up = std::array{UpAxis::x, UpAxis::y, UpAxis::z}[static_cast<std::size_t>(axis)];
  return stated;
}

void require_readable(const fs::path& file) {
  std::error_code error;
  const fs::file_status status = fs::status(file, error);
  if (!fs::exists(status)) fail(ErrorKind::io, file, "no such file");
  if (fs::is_directory(status)) fail(ErrorKind::io, file, "is a folder, not a mesh file");
  if (!fs::is_regular_file(status)) fail(ErrorKind::io, file, "is no regular file");
  std::ifstream in(file, std::ios::binary);
  if (!in) fail(ErrorKind::io, file, "cannot be opened: " + std::generic_category().message(errno));
  if (in.peek() == std::ifstream::traits_type::eof()) fail(ErrorKind::io, file, "is empty");
}

std::string reason_of(const Assimp::Importer& importer, const fs::path& file) {
  const std::string reason = importer.GetErrorString();
  const bool known = importer.IsExtensionSupported(file.extension().string());
  return (reason.empty() ? "cannot be read" : reason) +
         (known ? "" : "; is '" + file.extension().string() + "' the right extension?");
}

TexturedMesh read_by_assimp(const fs::path& file, const LoadSettings& settings) {
  Assimp::Importer importer;
  constexpr int kIgnored = aiComponent_TANGENTS_AND_BITANGENTS | aiComponent_TEXTURES | aiComponent_LIGHTS |
                           aiComponent_CAMERAS | aiComponent_ANIMATIONS | aiComponent_BONEWEIGHTS;
  importer.SetPropertyInteger(AI_CONFIG_PP_RVC_FLAGS, kIgnored);
  // assimp's reader of OFF takes any number for the index of a vertex.
  const unsigned checks = file.extension() == ".off" ? unsigned{aiProcess_ValidateDataStructure} : 0;
  const aiScene* scene = nullptr;
  try {
    scene = importer.ReadFile(file.string(), checks | aiProcess_Triangulate | aiProcess_RemoveComponent);
  } catch (const std::exception& error) {
    fail(ErrorKind::io, file, error.what());
  }
  if (scene == nullptr) fail(ErrorKind::io, file, reason_of(importer, file));
  TexturedMesh result = Collector(file, *scene, settings.part).take();
  const Stated stated = stated_by(*scene);
  result.metres_per_unit = settings.metres_per_unit.value_or(stated.metres_per_unit.value_or(1));
  result.up = settings.up.value_or(stated.up.value_or(UpAxis::y));
  return result;
}

// Damaged files make assimp crash, fail an assertion (Debian builds it with them) or go on and on, so it works in a
// process of its own, with many times the processor time that sound files take.
TexturedMesh read(const fs::path& file, const LoadSettings& settings) {
  require_readable(file);
  if (file.extension() == ".off") require_honest_off_header(file);
  require_ply_header_end(file);
  const double megabytes = 1e-6 * static_cast<double>(fs::file_size(file));
  try {
    return detail::unpacked(
        in_child_process([&] { return detail::packed(read_by_assimp(file, settings)); }, 60 + 5 * megabytes));
  } catch (const ChildFailed& failed) {
    fail(ErrorKind::io, file,
         std::string("is damaged or of a kind that cannot be read: the importer ") + failed.what());
  }
}

template <typename T>
void keep(std::vector<T>& list, const std::vector<char>& kept) {
  if (list.empty()) return;
  std::size_t count = 0;
  for (std::size_t i = 0; i < kept.size(); ++i) {
    if (kept[i]) list[count++] = list[i];
  }
  list.resize(count);
}

// Merges vertices at equal positions, across the seams of attributes, and drops what has no area then.
void weld(TexturedMesh& textured) {
  TriangleMesh& mesh = textured.mesh;
  const std::vector<int> same = detail::coincident(mesh.vertices, 0);
  std::vector<char> kept;
  for (Triangle& face : mesh.faces) {
    for (int& vertex : face) vertex = same[vertex];
    kept.push_back(!detail::names_a_vertex_twice(face));
  }
  keep(mesh.faces, kept);
  keep(textured.attributes.uv, kept);
  keep(textured.attributes.normal, kept);
  keep(textured.attributes.colour, kept);
  keep(textured.attributes.material, kept);
  mesh = detail::compacted(mesh);
}

void turn_normals(TexturedMesh& textured, const Mat3& rotation) {
  for (std::size_t i = 0; i < textured.attributes.normal.size(); ++i) {
    const auto& [a, b, c] = textured.mesh.faces[i];
    const Vec3& at = textured.mesh.vertices[a];
    const Vec3 flat = unit_or_zero((textured.mesh.vertices[b] - at).cross(textured.mesh.vertices[c] - at));
    for (Vec3& normal : textured.attributes.normal[i]) normal = normal.isZero(0) ? flat : Vec3(rotation * normal);
  }
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

TexturedMesh load_textured_mesh(const fs::path& file, const LoadSettings& settings) {
  TexturedMesh result = read(file, settings);
  if (result.mesh.faces.empty()) fail(ErrorKind::mesh, file, "holds no triangle");
  for (const Vec3& vertex : result.mesh.vertices) {
    if (!vertex.allFinite()) fail(ErrorKind::mesh, file, "holds a vertex whose position is not a finite number");
  }
  weld(result);
  if (result.mesh.faces.empty()) {
    fail(ErrorKind::mesh, file, "holds only triangles that have shrunk to a line or a point");
  }
  const Mat3 rotation = rotation_to_y_up(result.up);
  result.mesh = transformed(result.mesh, result.metres_per_unit * rotation, Vec3::Zero());
  turn_normals(result, rotation);
  return result;
}

TriangleMesh load_mesh(const fs::path& file, const LoadSettings& settings) {
  return load_textured_mesh(file, settings).mesh;
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
