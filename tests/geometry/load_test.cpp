#include "geometry/load.h"

#include <fstream>
#include <string>

#include <gtest/gtest.h>
#include <unistd.h>

#include "core/error.h"
#include "geometry/inspect.h"
#include "geometry/primitives.h"
#include "tests/geometry/shapes.h"

namespace sunder::geometry {
namespace {

namespace fs = std::filesystem;

// assimp keeps positions as floats.
constexpr double kFloat = 1e-7;

class Load : public testing::Test {
 protected:
  Load() : folder_(fs::temp_directory_path() / ("sunder_load_" + std::to_string(getpid()))) {
    fs::create_directories(folder_);
  }
  ~Load() override { fs::remove_all(folder_); }

  fs::path file(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name) << text;
    return folder_ / name;
  }

  fs::path path(const std::string& name) const { return folder_ / name; }

 private:
  fs::path folder_;
};

void expect_error(const fs::path& file, ErrorKind kind, const std::string& part) {
  try {
    load_mesh(file);
    ADD_FAILURE() << file << " was read";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), kind) << error.what();
    EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << error.what();
    EXPECT_NE(std::string(error.what()).find(file.filename().string()), std::string::npos) << error.what();
  }
}

std::string stl_facet(const Vec3& a, const Vec3& b, const Vec3& c) {
  std::string text = "facet normal 0 0 0\nouter loop\n";
  for (const Vec3& x : {a, b, c}) {
    text += "vertex " + std::to_string(x.x()) + " " + std::to_string(x.y()) + " " + std::to_string(x.z()) + "\n";
  }
  return text + "endloop\nendfacet\n";
}

TEST_F(Load, WrittenMeshesComeBack) {
  const TriangleMesh mesh = cup(0.1, 0.006);
  for (const char* name : {"cup.off", "cup.obj"}) {
    save_mesh(mesh, path(name));
    const TriangleMesh again = load_mesh(path(name));
    ASSERT_EQ(again.faces.size(), mesh.faces.size()) << name;
    EXPECT_TRUE(inspect(again).is_solid()) << name;
    EXPECT_NEAR(inspect(again).volume / inspect(mesh).volume, 1, 100 * kFloat) << name;
  }
}

TEST_F(Load, StlIsWelded) {
  const TriangleMesh cube = box({1, 2, 3});
  std::string text = "solid cube\n";
  for (const auto& [a, b, c] : cube.faces) text += stl_facet(cube.vertices[a], cube.vertices[b], cube.vertices[c]);
  const TriangleMesh mesh = load_mesh(file("cube.stl", text + "endsolid cube\n"));
  EXPECT_EQ(mesh.vertices.size(), 8u);
  EXPECT_TRUE(inspect(mesh).is_solid());
}

TEST_F(Load, PolygonsAreTriangulated) {
  const TriangleMesh mesh = load_mesh(file("quad.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n"));
  EXPECT_EQ(mesh.faces.size(), 2u);
}

TEST_F(Load, UnitsAndUpAxisAreConverted) {
  const fs::path cube = path("box.off");
  save_mesh(moved(box({1, 2, 3}), {10, 20, 30}), cube);
  const Vec3 from_z = bounds(load_mesh(cube, {0.01, UpAxis::z, ""})).center();
  const Vec3 from_x = bounds(load_mesh(cube, {0.01, UpAxis::x, ""})).center();
  EXPECT_LT((from_z - Vec3(0.1, 0.3, -0.2)).norm(), kFloat);
  EXPECT_LT((from_x - Vec3(-0.2, 0.1, 0.3)).norm(), kFloat);
  EXPECT_TRUE(inspect(load_mesh(cube, {0.01, UpAxis::z, ""})).is_solid());
  EXPECT_TRUE(inspect(load_mesh(cube, {0.01, UpAxis::x, ""})).is_solid());
}

// Two nodes share one mesh: moved by (5, 0, 0), and mirrored.
TEST_F(Load, NodeTransformsAreApplied) {
  const std::string dae =
      R"(<?xml version="1.0"?><COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><unit name="meter" meter="1"/><up_axis>Y_UP</up_axis></asset><library_geometries><geometry id="g"><mesh>
<source id="p"><float_array id="pa" count="12">0 0 0 1 0 0 0 1 0 0 0 1</float_array><technique_common>
<accessor source="#pa" count="4" stride="3"><param name="X" type="float"/><param name="Y" type="float"/><param name="Z" type="float"/>
</accessor></technique_common></source><vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<triangles count="4"><input semantic="VERTEX" source="#v" offset="0"/><p>0 2 1 0 1 3 1 2 3 0 3 2</p></triangles>
</mesh></geometry></library_geometries><library_visual_scenes><visual_scene id="s">
<node><translate>5 0 0</translate><instance_geometry url="#g"/></node><node><scale>-1 1 1</scale><instance_geometry url="#g"/></node>
</visual_scene></library_visual_scenes><scene><instance_visual_scene url="#s"/></scene></COLLADA>)";
  const MeshReport report = inspect(load_mesh(file("two.dae", dae)));
  EXPECT_TRUE(report.is_solid()) << report.summary();
  EXPECT_NEAR(report.volume, 2.0 / 6, kFloat);
  EXPECT_EQ(report.box.min(), Vec3(-1, 0, 0));
  EXPECT_EQ(report.box.max(), Vec3(6, 1, 1));
}

TEST_F(Load, MissingFile) { expect_error(path("nothing.obj"), ErrorKind::io, "no such file"); }
TEST_F(Load, EmptyFile) { expect_error(file("empty.obj", ""), ErrorKind::io, ""); }
TEST_F(Load, Garbage) { expect_error(file("garbage.ply", "this is not a mesh at all\n"), ErrorKind::io, ""); }
TEST_F(Load, UnknownFormat) { expect_error(file("text.qqq", "hello"), ErrorKind::io, "No suitable reader"); }
TEST_F(Load, NoFaces) {
  const std::string ply =
      "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\nend_header\n";
  expect_error(file("points.ply", ply + "0 0 0\n"), ErrorKind::mesh, "holds no triangle");
}
TEST_F(Load, NotANumber) {
  expect_error(file("nan.obj", "v 0 0 0\nv 1 0 0\nv 0 nan 0\nf 1 2 3\n"), ErrorKind::mesh, "not a finite number");
}
TEST_F(Load, CollapsedFaces) {
  expect_error(file("flat.obj", "v 1 1 1\nv 1 1 1\nv 0 0 0\nf 1 2 3\n"), ErrorKind::mesh, "shrunk");
}
TEST_F(Load, HeaderThatPromisesTooMuch) {
  expect_error(file("huge.off", "OFF\n2000000000 2000000000 0\n0 0 0\n"), ErrorKind::io, "shorter");
}

TEST_F(Load, SaveSaysWhatItCannotDo) {
  EXPECT_THROW(save_mesh(box({1, 1, 1}), path("box.xyz")), Error);
  EXPECT_THROW(save_mesh(box({1, 1, 1}), path("no/such/folder/box.off")), Error);
}

}  // namespace
}  // namespace sunder::geometry
