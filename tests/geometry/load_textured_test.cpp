#include <fstream>
#include <map>
#include <sstream>
#include <string>

#include <gtest/gtest.h>
#include <unistd.h>

#include "geometry/load.h"
#include "geometry/primitives.h"
#include "tests/geometry/cut_checks.h"
#include "tests/geometry/shapes.h"
#include "tests/geometry/voronoi_regions.h"

namespace sunder::geometry {
namespace {

namespace fs = std::filesystem;

// assimp keeps attributes as floats.
constexpr double kFloat = 1e-6;

class LoadTextured : public testing::Test {
 protected:
  LoadTextured() : folder_(fs::temp_directory_path() / ("sunder_load_textured_" + std::to_string(getpid()))) {
    fs::create_directories(folder_);
  }
  ~LoadTextured() override { fs::remove_all(folder_); }

  fs::path file(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name, std::ios::binary) << text;
    return folder_ / name;
  }

 private:
  fs::path folder_;
};

// A tetrahedron whose corners are the axes' unit points and the origin; uv = (x + 2 z, y) wherever given.
constexpr const char* kPoints = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n";
constexpr const char* kUvs = "vt 0 0\nvt 1 0\nvt 0 1\nvt 2 0\n";

Uv uv_at(const Vec3& x) { return {x.x() + 2 * x.z(), x.y()}; }

void expect_uv(const TexturedMesh& textured) {
  ASSERT_EQ(textured.attributes.uv.size(), textured.mesh.faces.size());
  for (std::size_t i = 0; i < textured.mesh.faces.size(); ++i) {
    for (int k = 0; k < 3; ++k) {
      EXPECT_EQ(textured.attributes.uv[i][k], uv_at(textured.mesh.vertices[textured.mesh.faces[i][k]]));
    }
  }
}

Vec3 flat_normal(const TriangleMesh& mesh, const Triangle& face) {
  const Vec3& a = mesh.vertices[face[0]];
  return (mesh.vertices[face[1]] - a).cross(mesh.vertices[face[2]] - a).normalized();
}

void expect_flat_normals(const TexturedMesh& textured, double tolerance) {
  ASSERT_EQ(textured.attributes.normal.size(), textured.mesh.faces.size());
  for (std::size_t i = 0; i < textured.mesh.faces.size(); ++i) {
    for (const Vec3& normal : textured.attributes.normal[i]) {
      EXPECT_LT((normal - flat_normal(textured.mesh, textured.mesh.faces[i])).norm(), tolerance) << i;
    }
  }
}

TEST_F(LoadTextured, ObjWithMaterials) {
  file("two.mtl", "newmtl unused\nKd 1 0 0\nnewmtl red\nKd 1 0 0\nnewmtl blue\nKd 0 0 1\n");
  const std::string text = std::string("mtllib two.mtl\n") + kPoints + kUvs +
                           "vn 0 0 -1\nvn 0 -1 0\nvn -1 0 0\nvn 1 1 1\nusemtl blue\nf 1/1/1 3/3/1 2/2/1\n"
                           "f 1/1/2 2/2/2 4/4/2\nusemtl red\nf 2/2/4 3/3/4 4/4/4\nf 1/1/3 4/4/3 3/3/3\n";
  const TexturedMesh textured = load_textured_mesh(file("two.obj", text));
  EXPECT_EQ(textured.mesh.vertices.size(), 4u);
  EXPECT_TRUE(inspect(textured.mesh).is_solid());
  EXPECT_TRUE(fits(textured.attributes, textured.mesh));
  expect_uv(textured);
  expect_flat_normals(textured, kFloat);
  ASSERT_EQ(textured.attributes.material_names.size(), 2u);
  std::map<std::string, int> faces;
  for (const int material : textured.attributes.material) ++faces[textured.attributes.material_names[material]];
  EXPECT_EQ(faces, (std::map<std::string, int>{{"red", 2}, {"blue", 2}}));
}

TEST_F(LoadTextured, WhatIsAbsentStaysAbsent) {
  const fs::path obj = file("bare.obj", std::string(kPoints) + "f 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n");
  EXPECT_TRUE(load_textured_mesh(obj).attributes == SurfaceAttributes{});
  const fs::path off = file("bare.off", "OFF\n4 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 0 3 2\n");
  EXPECT_TRUE(load_textured_mesh(off).attributes == SurfaceAttributes{});
}

TEST_F(LoadTextured, PartsWithoutGetZeroAndFlatNormals) {
  const std::string text =
      std::string(kPoints) + kUvs + "vn 0 0 -1\no one\nf 1/1/1 3/3/1 2/2/1\no two\nf 1 2 4\nf 2 3 4\nf 1 4 3\n";
  const TexturedMesh textured = load_textured_mesh(file("mixed.obj", text));
  EXPECT_TRUE(fits(textured.attributes, textured.mesh));
  ASSERT_EQ(textured.attributes.uv.size(), 4u);
  EXPECT_EQ(textured.attributes.uv[1][2], Uv(0, 0));
  expect_flat_normals(textured, kFloat);
}

TEST_F(LoadTextured, NormalsTurnWithTheAxes) {
  const std::string text = std::string(kPoints) +
                           "vn 0 0 -1\nvn 0 -1 0\nvn -1 0 0\nvn 1 1 1\nf 1//1 3//1 2//1\nf 1//2 2//2 4//2\n"
                           "f 2//4 3//4 4//4\nf 1//3 4//3 3//3\n";
  for (const UpAxis up : {UpAxis::x, UpAxis::y, UpAxis::z}) {
    expect_flat_normals(load_textured_mesh(file("up.obj", text), {0.01, up, ""}), kFloat);
  }
}

TEST_F(LoadTextured, CollapsedFacesTakeTheirAttributesAlong) {
  const std::string text = std::string(kPoints) + "v 1 0 0\n" + kUvs +
                           "f 2/2 5/2 3/3\nf 1/1 3/3 2/2\nf 1/1 2/2 4/4\nf 5/2 3/3 4/4\nf 1/1 4/4 3/3\n";
  const TexturedMesh textured = load_textured_mesh(file("collapsed.obj", text));
  EXPECT_EQ(textured.mesh.faces.size(), 4u);
  expect_uv(textured);
}

TEST_F(LoadTextured, Ply) {
  const std::string text =
      "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
      "property float nx\nproperty float ny\nproperty float nz\nproperty float s\nproperty float t\n"
      "element face 4\nproperty list uchar int vertex_indices\nend_header\n"
      "0 0 0 -1 -1 -1 0 0\n1 0 0 2 0 0 1 0\n0 1 0 0 2 0 0 1\n0 0 1 0 0 2 2 0\n"
      "3 0 2 1\n3 0 1 3\n3 1 2 3\n3 0 3 2\n";
  const TexturedMesh textured = load_textured_mesh(file("tetra.ply", text));
  EXPECT_TRUE(fits(textured.attributes, textured.mesh));
  expect_uv(textured);
  ASSERT_EQ(textured.attributes.normal.size(), 4u);
  EXPECT_EQ(textured.attributes.normal[0][1], Vec3(0, 1, 0));
  EXPECT_LT((textured.attributes.normal[0][0] + Vec3::Constant(std::sqrt(1.0 / 3))).norm(), kFloat);
  EXPECT_TRUE(textured.attributes.material.empty());
}

void append(std::string& bytes, const auto& value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof(value));
}

std::string base64(const std::string& bytes) {
  constexpr const char* digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t word = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      word = word << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0);
    }
    for (std::size_t k = 0; k < 4; ++k) text += i + k > bytes.size() ? '=' : digits[word >> (18 - 6 * k) & 63];
  }
  return text;
}

// Positions, normals, uv (v downward, as glTF has it) and indices of the tetrahedron; a node that mirrors and moves.
TEST_F(LoadTextured, GltfUnderAMirroringNode) {
  const std::vector<Vec3> points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  std::string bytes;
  for (const Vec3& x : points) {
    for (int axis = 0; axis < 3; ++axis) append(bytes, static_cast<float>(x[axis]));
  }
  for (int i = 0; i < 4; ++i) {
    for (const float n : {1.0F, 0.0F, 0.0F}) append(bytes, n);
  }
  for (const Vec3& x : points) {
    append(bytes, static_cast<float>(uv_at(x).x()));
    append(bytes, static_cast<float>(1 - uv_at(x).y()));
  }
  for (const int index : {0, 2, 1, 0, 1, 3, 1, 2, 3, 0, 3, 2}) append(bytes, static_cast<std::uint16_t>(index));
  const std::string text =
      R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],
"nodes":[{"mesh":0,"scale":[-2,1,1],"translation":[0,5,0]}],"materials":[{"name":"clay"}],
"meshes":[{"primitives":[{"attributes":{"POSITION":0,"NORMAL":1,"TEXCOORD_0":2},"indices":3,"material":0}]}],
"accessors":[{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3","min":[0,0,0],"max":[1,1,1]},
{"bufferView":1,"componentType":5126,"count":4,"type":"VEC3"},{"bufferView":2,"componentType":5126,"count":4,"type":"VEC2"},
{"bufferView":3,"componentType":5123,"count":12,"type":"SCALAR"}],
"bufferViews":[{"buffer":0,"byteOffset":0,"byteLength":48},{"buffer":0,"byteOffset":48,"byteLength":48},
{"buffer":0,"byteOffset":96,"byteLength":32},{"buffer":0,"byteOffset":128,"byteLength":24}],
"buffers":[{"byteLength":152,"uri":"data:application/octet-stream;base64,)" +
      base64(bytes) + R"("}]})";
  const TexturedMesh textured = load_textured_mesh(file("tetra.gltf", text));
  EXPECT_TRUE(inspect(textured.mesh).is_solid());
  EXPECT_NEAR(inspect(textured.mesh).volume, 2.0 / 6, kFloat);
  EXPECT_EQ(textured.attributes.material_names, std::vector<std::string>{"clay"});
  EXPECT_EQ(textured.attributes.material, std::vector<int>(4, 0));
  for (std::size_t i = 0; i < textured.mesh.faces.size(); ++i) {
    for (int k = 0; k < 3; ++k) {
      const Vec3& x = textured.mesh.vertices[textured.mesh.faces[i][k]];
      EXPECT_LT((textured.attributes.uv[i][k] - uv_at({x.x() / -2, x.y() - 5, x.z()})).norm(), kFloat);
      EXPECT_EQ(textured.attributes.normal[i][k], Vec3(-1, 0, 0));
    }
  }
}

TEST_F(LoadTextured, TextureSeamsDoNotOpenTheMeshAndSurviveACut) {
  // Every face of the box has a square of the texture of its own.
  const TriangleMesh cube = box({1, 1, 1});
  std::ostringstream text;
  for (const Vec3& x : cube.vertices) text << "v " << x.x() << ' ' << x.y() << ' ' << x.z() << '\n';
  for (std::size_t i = 0; i < cube.faces.size(); ++i) {
    text << "vt " << i << " 0\nvt " << i << ".5 0\nvt " << i << " 0.5\n";
  }
  for (std::size_t i = 0; i < cube.faces.size(); ++i) {
    text << 'f';
    for (int k = 0; k < 3; ++k) text << ' ' << cube.faces[i][k] + 1 << '/' << 3 * i + k + 1;
    text << '\n';
  }
  const TexturedMesh textured = load_textured_mesh(file("seams.obj", text.str()));
  ASSERT_TRUE(inspect(textured.mesh).is_solid());
  const RegionBoundary regions = random_regions(textured.mesh, 8, 4, 1);
  double area = 0;
  for (const Fragment& fragment : cut_silently(textured.mesh, regions).fragments) {
    const SurfaceAttributes got = carry(textured.mesh, textured.attributes, fragment, regions);
    for (std::size_t i = 0; i < got.uv.size(); ++i) {
      if (fragment.source_face[i] < 0) continue;
      const Uv p = got.uv[i][1] - got.uv[i][0], q = got.uv[i][2] - got.uv[i][0];
      area += (p.x() * q.y() - p.y() * q.x()) / 2;
    }
  }
  EXPECT_NEAR(area, 12 * 0.125, 1e-12);
}

TEST_F(LoadTextured, TheMeshIsThatOfLoadMesh) {
  const fs::path bunny = sample_mesh("bunny00.off");
  if (!fs::exists(bunny)) GTEST_SKIP() << bunny << " is missing";
  const TriangleMesh mesh = load_mesh(bunny);
  const TexturedMesh textured = load_textured_mesh(bunny);
  EXPECT_EQ(textured.mesh.vertices, mesh.vertices);
  EXPECT_EQ(textured.mesh.faces, mesh.faces);
}

}  // namespace
}  // namespace sunder::geometry
