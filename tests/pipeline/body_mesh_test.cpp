/// Bodies come out of the scene in the right size, place and attitude, and broken meshes are mended or refused.
#include <numbers>

#include <gtest/gtest.h>

#include "core/error.h"
#include "geometry/inspect.h"
#include "geometry/load.h"
#include "geometry/mass_properties.h"
#include "geometry/primitives.h"
#include "pipeline/detail/mesh_catalogue.h"
#include "pipeline/scene.h"
#include "tests/output/scratch_folder.h"

namespace sunder::pipeline {
namespace {

constexpr double kRounding = 1e-12;  // a few rounded products of lengths of order one

void expect_near(const Vec3& actual, const Vec3& expected) {
  EXPECT_LT((actual - expected).lpNorm<Eigen::Infinity>(), kRounding) << actual.transpose();
}

SceneBody box_body() {
  SceneBody body;
  body.name = "box";
  body.mesh.name = "box";
  body.mesh.size = Vec3(1, 2, 3);
  body.line = 3;
  return body;
}

// A body whose mesh is a box of 1 x 2 x 3 file units with its corner at the file's origin, less its first `missing`
// faces.
SceneBody file_body(const output::ScratchFolder& folder, int missing = 0) {
  geometry::TriangleMesh mesh =
      geometry::transformed(geometry::box(Vec3(1, 2, 3)), Mat3::Identity(), Vec3(0.5, 1, 1.5));
  mesh.faces.erase(mesh.faces.begin(), mesh.faces.begin() + missing);
  geometry::save_mesh(mesh, folder / "box.off");
  SceneBody body;
  body.name = "crate";
  body.mesh.name = "box.off";
  body.mesh.file = folder / "box.off";
  body.line = 12;
  return body;
}

TEST(BodyMesh, AnchorsByBaseCentreOrOrigin) {
  SceneBody body = box_body();
  body.position = Vec3(5, 6, 7);
  Box box = geometry::bounds(body_mesh(body).mesh);
  expect_near(box.min(), Vec3(4.5, 6, 5.5));
  expect_near(box.max(), Vec3(5.5, 8, 8.5));
  body.anchor = Anchor::centre;
  box = geometry::bounds(body_mesh(body).mesh);
  expect_near(box.center(), body.position);
  const output::ScratchFolder folder;
  SceneBody crate = file_body(folder);
  crate.anchor = Anchor::origin;
  crate.position = body.position;
  expect_near(geometry::bounds(body_mesh(crate).mesh).min(), body.position);
}

TEST(BodyMesh, TurnsBeforeItIsPlaced) {
  SceneBody body = box_body();
  body.position = Vec3(5, 6, 7);
  body.orientation = Eigen::AngleAxisd(std::numbers::pi / 2, Vec3::UnitX());
  const Box box = geometry::bounds(body_mesh(body).mesh);
  expect_near(box.sizes(), Vec3(1, 3, 2));
  expect_near(Vec3(box.center().x(), box.min().y(), box.center().z()), body.position);
}

TEST(BodyMesh, ConvertsUnitAndUpAxisAndScales) {
  const output::ScratchFolder folder;
  SceneBody body = file_body(folder);
  body.mesh.load.metres_per_unit = 0.01;
  expect_near(geometry::bounds(body_mesh(body).mesh).sizes(), Vec3(0.01, 0.02, 0.03));
  body.mesh.load.up = geometry::UpAxis::z;
  EXPECT_NEAR(geometry::bounds(body_mesh(body).mesh).sizes().y(), 0.03, kRounding);
  body.mesh.height = 1.5;
  EXPECT_NEAR(geometry::bounds(body_mesh(body).mesh).sizes().y(), 1.5, kRounding);
  EXPECT_NEAR(geometry::mass_properties(body_mesh(body).mesh).volume, 6 * 0.125, kRounding);
  body.mesh.height = 0;
  body.mesh.size = Vec3(3, 2, 1);
  expect_near(geometry::bounds(body_mesh(body).mesh).sizes(), Vec3(3, 2, 1));
}

TEST(BodyMesh, MakesEveryPrimitiveASolid) {
  struct Dimensions {
    const char* name;
    Vec3 size;
    double height;
  };
  const Vec3 none = Vec3::Zero();
  const std::vector<Dimensions> shapes = {
      {"box", {1, 2, 3}, 0},        {"plate", {1, 0.1, 1}, 0}, {"sphere", none, 0.5}, {"sphere", {1, 2, 3}, 0},
      {"cylinder", {1, 3, 1}, 0},   {"torus", {1, 0.2, 1}, 0}, {"cup", none, 0.1},    {"pot", none, 0.3},
      {"hollow_sphere", none, 0.5}, {"goblet", none, 0.2},     {"column", none, 2},
  };
  for (const auto& [name, size, height] : shapes) {
    SceneBody body;
    body.mesh.name = name;
    body.mesh.size = size;
    body.mesh.height = height;
    const BodyMesh result = body_mesh(body);
    EXPECT_TRUE(geometry::inspect(result.mesh).is_solid()) << name;
    EXPECT_TRUE(result.repair.steps.empty()) << name;
    const Box box = geometry::bounds(result.mesh);
    EXPECT_NEAR(box.sizes().y(), height > 0 ? height : size.y(), 0.01 * box.sizes().y()) << name;
    EXPECT_NEAR(box.min().y(), 0, kRounding) << name;
  }
}

TEST(BodyMesh, MendsAnOpenMeshAndSaysSo) {
  const output::ScratchFolder folder;
  const BodyMesh result = body_mesh(file_body(folder, 2));
  EXPECT_FALSE(result.repair.steps.empty());
  EXPECT_NEAR(geometry::mass_properties(result.mesh).volume, 6, kRounding);
  EXPECT_TRUE(body_mesh(file_body(folder)).repair.steps.empty());
}

std::string complaint(const SceneBody& body, ErrorKind kind) {
  try {
    body_mesh(body);
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), kind) << error.what();
    return error.what();
  }
  return "accepted";
}

TEST(BodyMesh, RefusesAnOpenMeshWhenRepairIsOff) {
  const output::ScratchFolder folder;
  SceneBody body = file_body(folder, 2);
  body.mesh.repair = RepairMode::off;
  const std::string message = complaint(body, ErrorKind::mesh);
  EXPECT_NE(message.find("body 'crate' (line 12)"), std::string::npos) << message;
  EXPECT_NE(message.find("box.off"), std::string::npos) << message;
  EXPECT_NE(message.find("boundary edges"), std::string::npos) << message;
  EXPECT_NE(message.find("repair"), std::string::npos) << message;
}

TEST(BodyMesh, RefusesWhatRepairCannotMend) {
  const output::ScratchFolder folder;
  const SceneBody body = file_body(folder, 11);  // one triangle encloses nothing
  const std::string message = complaint(body, ErrorKind::mesh);
  EXPECT_NE(message.find("body 'crate'"), std::string::npos) << message;
}

TEST(BodyMesh, NamesTheBodyOfAnUnreadableFile) {
  const output::ScratchFolder folder;
  SceneBody body = file_body(folder);
  std::ofstream(body.mesh.file) << "no mesh";
  const std::string message = complaint(body, ErrorKind::io);
  EXPECT_NE(message.find("body 'crate' (line 12): "), std::string::npos) << message;
}

TEST(MeshCatalogue, NamesFilesThatExist) {
  const AssetPaths assets = default_assets();
  const detail::MeshCatalogue catalogue = detail::load_catalogue(assets.meshes);
  for (const char* name : {"bunny", "armadillo", "elephant", "lion_head", "camel", "cow"})
    EXPECT_TRUE(catalogue.contains(name)) << name;
  if (!std::filesystem::is_directory(assets.mesh_cache)) GTEST_SKIP() << "the demo meshes are not unpacked";
  for (const auto& [name, mesh] : catalogue)
    EXPECT_TRUE(std::filesystem::is_regular_file(assets.mesh_cache / mesh.file)) << name;
}

// The scenes are only examples if their bodies are where their comments say.
TEST(ShippedScenes, BodiesStandOnOrAboveTheGround) {
  if (!std::filesystem::is_directory(default_assets().mesh_cache)) GTEST_SKIP() << "the demo meshes are not unpacked";
  for (const auto& entry : std::filesystem::directory_iterator(SUNDER_SOURCE_DIR "/assets/scenes")) {
    const Scene scene = load_scene(entry.path());
    for (const SceneBody& body : scene.bodies) {
      const Box box = geometry::bounds(body_mesh(body).mesh);
      if (scene.ground) {
        EXPECT_GE(box.min().y(), scene.ground->height) << entry.path() << " " << body.name;
      }
    }
  }
}

}  // namespace
}  // namespace sunder::pipeline
