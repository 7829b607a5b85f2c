#include "geometry/level_set_cut.h"

#include <gtest/gtest.h>

#include "geometry/inspect.h"
#include "geometry/primitives.h"
#include "tests/geometry/delaunay_regions.h"
#include "tests/geometry/shapes.h"

namespace sunder::geometry {
namespace {

constexpr int kRegions = 6;
// Level sets round every edge off: along it a prism is lost whose section grows with the square of the voxel. Measured:
// 59, 66 and 136 times (voxel / diagonal)^2 for the shapes below; the torus has the most edge for its volume.
constexpr double kLoss = 200;

CutResult cut_at(const TriangleMesh& body, double voxels) {
  SilentProgress progress;
  const double voxel = bounds(body).diagonal().norm() / voxels;
  return level_set_cut(body, cell_regions(body, kRegions, 2, 1), {voxel}, progress);
}

TEST(LevelSetCut, GivesClosedPiecesAndLosesLittle) {
  for (const TriangleMesh& body : {box({1, 0.7, 0.5}), sphere(1, 3), torus(1, 0.4, 48, 24)}) {
    std::vector<double> losses;
    for (const double voxels : {50.0, 100.0}) {
      const CutResult result = cut_at(body, voxels);
      ASSERT_EQ(result.status, CutStatus::ok) << result.detail;
      EXPECT_GE(result.fragments.size(), static_cast<std::size_t>(kRegions));
      for (const Fragment& fragment : result.fragments) {
        EXPECT_TRUE(is_closed_two_manifold(fragment.mesh));
        ASSERT_EQ(fragment.source_face.size(), fragment.mesh.faces.size());
        EXPECT_TRUE(std::any_of(fragment.source_face.begin(), fragment.source_face.end(), [](int f) { return f < 0; }));
      }
      EXPECT_LE(result.volume_error, kLoss / (voxels * voxels));
      losses.push_back(result.volume_error);
      std::printf("%g voxels: %zu fragments, loss %.4f\n", voxels, result.fragments.size(), result.volume_error);
    }
    EXPECT_LT(losses[1], losses[0]);
  }
}

TEST(LevelSetCut, TakesBodiesThatIntersectThemselves) {
  const TriangleMesh body = together(sphere(1, 2), moved(sphere(1, 2), {0.8, 0.1, 0}));
  const CutResult result = cut_at(body, 60);
  ASSERT_EQ(result.status, CutStatus::ok) << result.detail;
  EXPECT_GE(result.fragments.size(), static_cast<std::size_t>(kRegions));
}

TEST(LevelSetCut, RefusesWhatIsNoBodyOrRegion) {
  SilentProgress progress;
  const TriangleMesh body = sphere(1, 2);
  RegionBoundary broken = cell_regions(body, 2, 2, 1);
  broken.faces[0].loop[0] = 1 << 20;
  EXPECT_EQ(level_set_cut({}, cell_regions(body, 2, 2, 1), {}, progress).status, CutStatus::bad_input);
  EXPECT_EQ(level_set_cut(body, broken, {}, progress).status, CutStatus::bad_input);
}

}  // namespace
}  // namespace sunder::geometry
