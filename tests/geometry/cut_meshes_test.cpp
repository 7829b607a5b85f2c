/// Cuts of scanned and constructed meshes.
#include <gtest/gtest.h>

#include "geometry/load.h"
#include "geometry/repair.h"
#include "tests/geometry/cut_checks.h"
#include "tests/geometry/delaunay_regions.h"
#include "tests/geometry/shapes.h"

namespace sunder::geometry {
namespace {

class CutMeshSlow : public testing::TestWithParam<const char*> {};

TEST_P(CutMeshSlow, FallsIntoSolids) {
  const auto file = sample_mesh(GetParam());
  if (!std::filesystem::exists(file)) GTEST_SKIP() << file << " is missing";
  TriangleMesh body = load_mesh(file);
  if (!inspect(body).is_solid()) {
    const RepairResult repaired = repair(body, {.allow_remesh = false});
    if (!repaired.solid) GTEST_SKIP() << "cannot be repaired: " << repaired.after.summary();
    body = repaired.mesh;
  }
  for (const std::uint64_t seed : {1, 2}) {
    const CutResult result = cut_silently(body, cell_regions(body, 40, 3, seed));
    ASSERT_EQ(result.status, CutStatus::ok) << result.detail;
    EXPECT_EQ(broken_cut(body, result), "");
    EXPECT_GE(result.fragments.size(), 40u);
    std::printf("%s: %zu fragments, %d nudges, volume error %.1e\n", GetParam(), result.fragments.size(), result.nudges,
                result.volume_error);
  }
}

INSTANTIATE_TEST_SUITE_P(Meshes, CutMeshSlow,
                         testing::Values("bunny00.off", "armadillo.off", "elephant.off", "fandisk.off", "knot1.off",
                                         "rotor.off", "pinion.off", "couplingdown.off", "dino.off", "femur.off",
                                         "refined_elephant.off", "blobby.off", "camel.off", "cow.off"));

}  // namespace
}  // namespace sunder::geometry
