/// What an artist's mesh carries, followed through repair, scale and breaking into the fragments.
#include <fstream>
#include <sstream>

#include <gtest/gtest.h>

#include "geometry/primitives.h"
#include "output/atomic_file.h"
#include "pipeline/still.h"

namespace sunder::pipeline {
namespace {

namespace fs = std::filesystem;

// Positions go through assimp's single precision.
constexpr double kSingle = 2e-6;

/// A sphere of radius 0.1 with uv = (x, y) in metres, radial normals and two materials, as OBJ. `hole`: without its
/// last faces.
std::string textured_sphere(bool hole) {
  const geometry::TriangleMesh mesh = geometry::sphere(0.1, 3);
  std::ostringstream out;
  for (const Vec3& x : mesh.vertices) out << "v " << x.x() << ' ' << x.y() << ' ' << x.z() << '\n';
  for (const Vec3& x : mesh.vertices) out << "vt " << x.x() << ' ' << x.y() << '\n';
  for (const Vec3& x : mesh.vertices) out << "vn " << x.x() << ' ' << x.y() << ' ' << x.z() << '\n';
  const std::size_t count = mesh.faces.size() - (hole ? 3 : 0);
  for (std::size_t f = 0; f < count; ++f) {
    if (f == 0) out << "usemtl glaze\n";
    if (f == count / 2) out << "usemtl bare clay\n";
    out << 'f';
    for (const int v : mesh.faces[f]) out << ' ' << v + 1 << '/' << v + 1 << '/' << v + 1;
    out << '\n';
  }
  return out.str();
}

class ArtistMesh : public testing::Test {
 protected:
  void SetUp() override { output::create_folder(folder_); }
  void TearDown() override { fs::remove_all(folder_); }

  StillResult shattered(const std::string& name, const std::string& text) const {
    output::write_atomically(folder_ / name, text);
    FractureOptions options;
    options.mesh = folder_ / name;
    options.out = folder_ / "out";
    options.cells = 12;
    SilentProgress progress;
    return fracture_mesh(options, progress);
  }

  const fs::path folder_ = fs::path(testing::TempDir()) / ("sunder_artist_mesh_" + std::to_string(getpid()));
};

/// Checks uv and normals at every outside corner; returns how many faces were checked.
int expect_carried(const output::Piece& piece, double slack) {
  int checked = 0;
  for (std::size_t f = 0; f < piece.mesh.faces.size(); ++f) {
    if (piece.inside(f)) continue;
    ++checked;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3& x = piece.mesh.vertices[static_cast<std::size_t>(piece.mesh.faces[f][k])];
      EXPECT_LT((piece.surface.uv[f][k] - x.head<2>()).norm(), slack);
      // Interpolated between radial normals of the corners of an edge of at most 0.3 of the radius.
      EXPECT_GT(piece.surface.normal[f][k].dot(x.normalized()), 0.99);
    }
  }
  return checked;
}

TEST_F(ArtistMesh, FragmentsKeepTextureNormalsAndMaterials) {
  const StillResult result = shattered("pot.obj", textured_sphere(false));
  const output::Piece& whole = result.sequence.pieces.at(0);
  EXPECT_EQ(whole.surface.material_names, (std::vector<std::string>{"glaze", "bare clay"}));
  ASSERT_GT(result.sequence.pieces.size(), 5u);
  int outside = 0, inside = 0;
  for (const output::PiecePose& pose : result.sequence.frames.at(0).poses) {
    const output::Piece& piece = result.sequence.pieces.at(static_cast<std::size_t>(pose.piece));
    ASSERT_TRUE(geometry::fits(piece.surface, piece.mesh));
    outside += expect_carried(piece, kSingle);
    for (std::size_t f = 0; f < piece.mesh.faces.size(); ++f) {
      const std::string& material =
          piece.surface.material_names.at(static_cast<std::size_t>(piece.surface.material[f]));
      if (piece.inside(f)) {
        ++inside;
        EXPECT_EQ(material, "glass_inside");
      } else {
        const auto source = static_cast<std::size_t>(piece.source_face[f]);
        EXPECT_EQ(material, whole.surface.material_names[static_cast<std::size_t>(whole.surface.material[source])]);
      }
    }
  }
  EXPECT_GT(outside, 1000);
  EXPECT_GT(inside, 20);
}

TEST_F(ArtistMesh, AMendedMeshKeepsWhatWasNotMended) {
  const StillResult result = shattered("pot.obj", textured_sphere(true));
  ASSERT_EQ(result.report.repairs.size(), 1u);
  const output::Piece& whole = result.sequence.pieces.at(0);
  int bare = 0;
  for (std::size_t f = 0; f < whole.mesh.faces.size(); ++f) {
    const bool filled = whole.surface.uv[f][0].isZero(0) && whole.surface.uv[f][1].isZero(0);
    bare += filled;
    if (filled) continue;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3& x = whole.mesh.vertices[static_cast<std::size_t>(whole.mesh.faces[f][k])];
      EXPECT_LT((whole.surface.uv[f][k] - x.head<2>()).norm(), kSingle);
    }
  }
  EXPECT_GE(bare, 1) << "what fills the hole has no texture";
  EXPECT_LE(bare, 10);
}

TEST_F(ArtistMesh, FragmentsKeepVertexColours) {
  const geometry::TriangleMesh mesh = geometry::sphere(0.1, 3);
  std::ostringstream out;
  out << "ply\nformat ascii 1.0\nelement vertex " << mesh.vertices.size()
      << "\nproperty float x\nproperty float y\nproperty float z\nproperty uchar red\nproperty uchar green\n"
      << "property uchar blue\nelement face " << mesh.faces.size()
      << "\nproperty list uchar int vertex_indices\nend_header\n";
  for (const Vec3& x : mesh.vertices)
    out << x.x() << ' ' << x.y() << ' ' << x.z() << (x.x() > 0 ? " 255 0 0\n" : " 0 0 255\n");
  for (const auto& [a, b, c] : mesh.faces) out << "3 " << a << ' ' << b << ' ' << c << '\n';
  const StillResult result = shattered("pot.ply", out.str());
  int red = 0, blue = 0, white = 0;
  for (const output::PiecePose& pose : result.sequence.frames.at(0).poses) {
    const output::Piece& piece = result.sequence.pieces.at(static_cast<std::size_t>(pose.piece));
    ASSERT_EQ(piece.surface.colour.size(), piece.mesh.faces.size());
    for (std::size_t f = 0; f < piece.mesh.faces.size(); ++f)
      for (std::size_t k = 0; k < 3; ++k) {
        const geometry::Colour& colour = piece.surface.colour[f][k];
        const double x = piece.mesh.vertices[static_cast<std::size_t>(piece.mesh.faces[f][k])].x();
        if (piece.inside(f)) white += colour == geometry::Colour::Ones();
        if (piece.inside(f) || std::abs(x) < 0.02) continue;  // an edge of the mesh is shorter
        EXPECT_LT((colour - geometry::Colour(x > 0, 0, x < 0, 1)).norm(), 1e-6);
        (x > 0 ? red : blue) += 1;
      }
  }
  EXPECT_GT(red, 500);
  EXPECT_GT(blue, 500);
  EXPECT_GT(white, 50);
}

TEST(ScaledNormals, StayNormal) {
  geometry::SurfaceAttributes attributes;
  const Vec3 n = Vec3(1, 1, 0).normalized();
  attributes.normal = {{n, n, n}};
  geometry::transform_normals(attributes, Vec3(2, 1, 1).asDiagonal());
  // The plane x + y = 0 becomes x / 2 + y = 0.
  EXPECT_LT((attributes.normal[0][0] - Vec3(0.5, 1, 0).normalized()).norm(), 1e-15);
}

}  // namespace
}  // namespace sunder::pipeline
