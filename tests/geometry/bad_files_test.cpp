/// Files that are no meshes: one clear error each, with the right exit code.
#include <fstream>
#include <limits>

#include <gtest/gtest.h>
#include <unistd.h>

#include "core/error.h"
#include "geometry/load.h"
#include "geometry/primitives.h"

namespace sunder::geometry {
namespace {

namespace fs = std::filesystem;

struct BadFile {
  std::string name, content;
  ErrorKind kind;
  std::string says;  ///< part of the message
};

void PrintTo(const BadFile& file, std::ostream* out) { *out << file.name; }

std::string stl_head(std::uint32_t triangles) {
  std::string bytes(80, ' ');
  bytes.append(reinterpret_cast<const char*>(&triangles), sizeof triangles);
  return bytes;
}

const std::vector<BadFile> bad_files = {
    {"empty.obj", "", ErrorKind::io, "is empty"},
    {"empty.glb", "", ErrorKind::io, "is empty"},
    {"empty.fbx", "", ErrorKind::io, "is empty"},
    {"points.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n", ErrorKind::mesh, "no triangle"},
    {"far_index.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4000000000\n", ErrorKind::io, ""},
    {"negative_index.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf -7 -2 -1\n", ErrorKind::io, ""},
    {"nan.off", "OFF\n3 1 0\n0 0 0\nnan 0 0\n0 1 0\n3 0 1 2\n", ErrorKind::mesh, "not a finite number"},
    {"promises.off", "OFF\n2000000000 2000000000 0\n0 0 0\n", ErrorKind::io, "shorter than its header"},
    {"truncated.glb", std::string("glTF\2\0\0\0\377\0\0\0", 12), ErrorKind::io, ""},
    {"promises.stl", stl_head(4'000'000'000u), ErrorKind::io, ""},
    {"truncated.fbx", std::string("Kaydara FBX Binary  \0\x1a\0\xe8\x1c\0\0", 27), ErrorKind::io, ""},
    {"picture.obj", std::string("\x89PNG\r\n\x1a\n\0\0\0\rIHDR", 16), ErrorKind::mesh, "no triangle"},
    {"text.glb", "once upon a time", ErrorKind::io, ""},
    {"mesh.docx", "once upon a time", ErrorKind::io, "right extension"},
    {"broken.gltf", "{\"asset\":{\"version\":\"2.0\"},\"meshes\":[{", ErrorKind::io, ""},
    {"endless.ply", "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\n_header\n0\n", ErrorKind::io,
     "end_header"},
    {"text_faces.off",
     "OFF\n8 9 0\n0 0 0\n0 0 1\n0 1 0\n0 1 1\n1 0 0\n1 0 1\n1 1 0\n1 1 0\nfacet normal 0 0 0\nouter loop\nvertex 0 0 "
     "0\n"
     "vertex 0 0 1\nvertex 0 1 1\nendloop\nendfacet\nfacet normal 0 0 0\nouter loop\nvertex 0 1 0\n",
     ErrorKind::io, ""},
    {"line.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 1\n", ErrorKind::mesh, ""},
};

class BadFiles : public testing::TestWithParam<BadFile> {
 protected:
  void SetUp() override { fs::create_directories(folder_); }
  void TearDown() override { fs::remove_all(folder_); }
  const fs::path folder_ = fs::path(testing::TempDir()) / ("sunder_bad_files_" + std::to_string(getpid()));
};

TEST_P(BadFiles, GiveOneClearError) {
  const fs::path file = folder_ / GetParam().name;
  std::ofstream(file, std::ios::binary) << GetParam().content;
  try {
    load_mesh(file);
    FAIL() << "was read";
  } catch (const Error& error) {
    const std::string message = error.what();
    EXPECT_EQ(error.kind(), GetParam().kind) << message;
    EXPECT_TRUE(message.starts_with(file.string() + ": ")) << message;
    EXPECT_GT(message.size(), file.string().size() + std::string(": is bad").size()) << "says why";
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    EXPECT_NE(message.find(GetParam().says), std::string::npos) << message;
  }
}

INSTANTIATE_TEST_SUITE_P(All, BadFiles, testing::ValuesIn(bad_files), [](const auto& file) {
  std::string name = file.param.name;
  std::replace(name.begin(), name.end(), '.', '_');
  return name;
});

TEST_F(BadFiles, FoldersPipesAndMissingFilesAreNamedAsSuch) {
  const auto message = [](const fs::path& file) -> std::string {
    try {
      load_mesh(file);
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::io);
      return error.what();
    }
    return "";
  };
  EXPECT_NE(message(folder_).find("is a folder"), std::string::npos);
  EXPECT_NE(message(folder_ / "none.obj").find("no such file"), std::string::npos);
  EXPECT_NE(message("/dev/null").find("no regular file"), std::string::npos);
  std::ofstream(folder_ / "secret.obj") << "v 0 0 0\n";
  fs::permissions(folder_ / "secret.obj", fs::perms::none);
  if (geteuid() != 0) {
    EXPECT_NE(message(folder_ / "secret.obj").find("cannot be opened"), std::string::npos);
  }
}

/// Cut off anywhere, a file of a format with counts or structure is refused or gives a mesh, and never a crash.
TEST_F(BadFiles, AnyPrefixOfAMeshIsReadOrRefused) {
  const fs::path whole = folder_ / "whole.off";
  save_mesh(sphere(1, 1), whole);
  std::ifstream in(whole, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(in), {}};
  int refused = 0, read = 0;
  for (std::size_t length = 0; length < text.size(); length += 37) {
    const fs::path part = folder_ / "part.off";
    std::ofstream(part, std::ios::binary) << text.substr(0, length);
    try {
      const TriangleMesh mesh = load_mesh(part);
      ++read;
      for (const auto& face : mesh.faces)
        for (const int vertex : face) ASSERT_LT(vertex, static_cast<int>(mesh.vertices.size()));
    } catch (const Error&) {
      ++refused;
    }
  }
  EXPECT_GT(refused, 10);
}

TEST_F(BadFiles, NamesOfMaterialsBecomeText) {
  const fs::path file = folder_ / "names.obj";
  std::ofstream(file, std::ios::binary)
      << "mtllib names.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nusemtl gr\xfcn\nf 1 2 3\nusemtl gr\xc3\xbcn\nf 1 2 4\n";
  std::ofstream(folder_ / "names.mtl", std::ios::binary) << "newmtl gr\xfcn\nKd 0 1 0\nnewmtl gr\xc3\xbcn\nKd 0 1 0\n";
  EXPECT_EQ(load_textured_mesh(file).attributes.material_names, (std::vector<std::string>{"gr_n", "gr\xc3\xbcn"}));
}

TEST_F(BadFiles, APartIsFoundOrTheOthersAreListed) {
  const fs::path file = folder_ / "two.obj";
  std::ofstream(file) << "o left\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\no right\nv 5 0 0\nv 6 0 0\nv 5 1 0\nf 4 5 6\n";
  EXPECT_EQ(load_mesh(file).faces.size(), 2u);
  LoadSettings settings;
  settings.part = "right";
  const TriangleMesh right = load_mesh(file, settings);
  ASSERT_EQ(right.faces.size(), 1u);
  EXPECT_GE(bounds(right).min().x(), 5);
  settings.part = "rihgt";
  try {
    load_mesh(file, settings);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::mesh);
    EXPECT_NE(std::string(error.what()).find("'left', 'right'"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace sunder::geometry
