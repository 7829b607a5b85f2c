#include "pipeline/accuracy_measures.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "geometry/primitives.h"

namespace sunder::pipeline {
namespace {

/// A unit cube that a square at height `z` splits; a tenth of the failed points everywhere on it.
FractureTrace split_at(double z) {
  FractureTrace trace;
  trace.box = Box(Vec3::Zero(), Vec3::Ones());
  trace.volume = 1;
  trace.crack.vertices = {{0, 0, z}, {1, 0, z}, {1, 1, z}, {0, 1, z}};
  trace.crack.faces = {{0, 1, 2}, {0, 2, 3}};
  for (double x = 0.05; x < 1; x += 0.1)
    for (double y = 0.05; y < 1; y += 0.1) trace.failed.emplace_back(x, y, z);
  trace.shares = {std::max(z, 1 - z), std::min(z, 1 - z)};
  return trace;
}

FractureTrace whole() {
  FractureTrace trace = split_at(0.5);
  trace.crack.faces.clear();
  trace.failed.clear();
  trace.shares = {1};
  return trace;
}

RC_GTEST_PROP(AccuracyMeasures, ParallelCracksAreTheirGapApart, ()) {
  const double a = *rc::gen::inRange(100, 900) * 1e-3, b = *rc::gen::inRange(100, 900) * 1e-3;
  const TraceDistance d = distance(split_at(a), split_at(b));
  RC_ASSERT(std::abs(*d.crack_mean * std::sqrt(3.0) - std::abs(a - b)) < 1e-12);
  RC_ASSERT(std::abs(*d.crack_hausdorff * std::sqrt(3.0) - std::abs(a - b)) < 1e-12);
  // All of the volume is in pieces whose sizes differ by the gap at most, and the gap's volume changes its piece.
  RC_ASSERT(d.volumes <= 2 * std::abs(a - b) + 1e-12);
  RC_ASSERT((d.damage == 0) == (std::floor(a * 16 / std::sqrt(3.0)) == std::floor(b * 16 / std::sqrt(3.0))));
}

TEST(AccuracyMeasures, NothingIsBetweenEqualResults) {
  const TraceDistance d = distance(split_at(0.3), split_at(0.3));
  EXPECT_EQ(d.damage, 0);
  EXPECT_EQ(d.volumes, 0);
  EXPECT_NEAR(*d.crack_mean, 0, 1e-15);
}

TEST(AccuracyMeasures, AWholeBodyHasNoCrackToCompare) {
  const TraceDistance d = distance(whole(), split_at(0.5));
  EXPECT_FALSE(d.crack_mean);
  EXPECT_EQ(d.damage, 1);
  // All of the volume is in pieces of half the size.
  EXPECT_NEAR(d.volumes, 0.5, 1e-12);
}

}  // namespace
}  // namespace sunder::pipeline
