#include "geometry/sample.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <map>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "core/error.h"
#include "geometry/load.h"
#include "geometry/mass_properties.h"
#include "geometry/primitives.h"
#include "tests/geometry/shapes.h"

namespace sunder::geometry {
namespace {

constexpr double kCount = 0.03;  // the promise of the header

Samples sampled(const TriangleMesh& mesh, const SampleSettings& settings = {}) {
  SilentProgress progress;
  return sample_solid(mesh, settings, progress);
}

double solid_angle(const Vec3& a, const Vec3& b, const Vec3& c) {
  const double la = a.norm(), lb = b.norm(), lc = c.norm();
  return 2 * std::atan2(a.dot(b.cross(c)), la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
}

// Winding number by solid angles (Van Oosterom and Strackee 1983): independent of any ray.
double winding(const TriangleMesh& mesh, const Vec3& x) {
  double sum = 0;
  for (const auto& [a, b, c] : mesh.faces)
    sum += solid_angle(mesh.vertices[a] - x, mesh.vertices[b] - x, mesh.vertices[c] - x);
  return sum / (4 * M_PI);
}

void expect_inside(const TriangleMesh& mesh, const std::vector<Vec3>& points, std::size_t stride) {
  for (std::size_t i = 0; i < points.size(); i += stride) ASSERT_NEAR(winding(mesh, points[i]), 1, 1e-6) << i;
}

TEST(Sample, CountAndSpacing) {
  for (const TriangleMesh& mesh : {box({1, 2, 3}), sphere(1), torus(1, 0.3), cup(0.1, 0.006), pot(0.3, 0.015),
                                   goblet(0.2, 0.002), column(3), hollow_sphere(1, 0.05)}) {
    for (const int count : {2000, 20000}) {
      const Samples samples = sampled(mesh, {count});
      EXPECT_NEAR(static_cast<double>(samples.points.size()) / count, 1, kCount);
      EXPECT_DOUBLE_EQ(samples.spacing, std::cbrt(mass_properties(mesh).volume / count));
    }
  }
}

TEST(Sample, PointsLieInside) {
  for (const TriangleMesh& mesh : {sphere(1, 3), cup(0.1, 0.006), hollow_sphere(1, 0.1, 3)}) {
    expect_inside(mesh, sampled(mesh, {2000}).points, 20);
  }
}

TEST(Sample, MomentsAreThoseOfTheSolid) {
  const TriangleMesh mesh = column(3);
  const MassProperties mass = mass_properties(mesh);
  const Samples samples = sampled(mesh);
  Vec3 centroid = Vec3::Zero();
  for (const Vec3& x : samples.points) centroid += x / static_cast<double>(samples.points.size());
  EXPECT_LT((centroid - mass.centroid).norm(), 0.2 * samples.spacing);
}

TEST(Sample, JitterKeepsPointsApart) {
  // Neighbours on the lattice come no closer than spacing (1 - 2 jitter).
  const Samples samples = sampled(box({1, 1, 1}), {2000});
  double closest = 1;
  for (std::size_t i = 0; i < samples.points.size(); ++i) {
    for (std::size_t j = i + 1; j < samples.points.size(); ++j)
      closest = std::min(closest, (samples.points[i] - samples.points[j]).norm());
  }
  EXPECT_GT(closest, 0.48 * samples.spacing);
  EXPECT_LT(closest, 0.9 * samples.spacing);
}

TEST(Sample, SameSeedSamePoints) {
  const TriangleMesh mesh = cup(0.1, 0.006);
  EXPECT_EQ(sampled(mesh, {5000, 0.25, 7}).points, sampled(mesh, {5000, 0.25, 7}).points);
  EXPECT_NE(sampled(mesh, {5000, 0.25, 7}).points, sampled(mesh, {5000, 0.25, 8}).points);
}

// 20 x 20 x 1 cm at 20000 points: 3.7 spacings across, so four even layers, jittered by at most a quarter of a layer.
TEST(Sample, PlateIsLayeredEvenly) {
  const double thickness = 0.01;
  const Mat3 tilt = Eigen::AngleAxisd(0.8, Vec3(1, 2, 3).normalized()).toRotationMatrix();
  const TriangleMesh plate = transformed(box({0.2, thickness, 0.2}), tilt, Vec3(1, 2, 3));
  const Samples samples = sampled(plate);
  std::map<int, int> layers;
  for (const Vec3& x : samples.points) {
    const double depth = (tilt.transpose() * (x - Vec3(1, 2, 3))).y() / thickness + 0.5;
    const double layer = depth * 4 - 0.5, nearest = std::round(layer);
    ASSERT_LE(std::abs(layer - nearest), 0.25 + 1e-9);
    ++layers[static_cast<int>(nearest)];
  }
  ASSERT_EQ(layers.size(), 4u);
  const double quarter = samples.points.size() / 4.0;
  for (const auto& [layer, count] : layers) EXPECT_NEAR(count / quarter, 1, 0.01) << layer;
}

TEST(Sample, RodIsLayeredBothWays) {
  const TriangleMesh rod = box({0.01, 0.3, 0.01});
  const Samples samples = sampled(rod, {2000});
  EXPECT_NEAR(samples.points.size() / 2000.0, 1, kCount);
  expect_inside(rod, samples.points, 10);
}

TEST(Sample, RefusesWhatIsNoSolid) {
  EXPECT_THROW(sampled(inside_out(box({1, 1, 1}))), Error);
  EXPECT_THROW(sampled({}), Error);
  EXPECT_THROW(sampled(box({1, 1, 1}), {0}), Error);
}

TEST(Sample, StopsWhenAsked) {
  class Stop final : public Progress {
    void report(std::string_view, double) override {}
    bool cancelled() const override { return true; }
  } stop;
  EXPECT_THROW(sample_solid(box({1, 1, 1}), {}, stop), Error);
}

TEST(Sample, ScannedMesh) {
  const auto file = sample_mesh("bunny00.off");
  if (!std::filesystem::exists(file)) GTEST_SKIP() << file << " is missing";
  const TriangleMesh bunny = load_mesh(file);
  const Samples samples = sampled(bunny);
  EXPECT_NEAR(samples.points.size() / 20000.0, 1, kCount);
  expect_inside(bunny, samples.points, 1000);
}

RC_GTEST_PROP(Sample, AnySolidIsFilled, ()) {
  const TriangleMesh mesh = transformed(arbitrary_shape(), arbitrary_rotation(), arbitrary_vector(2));
  const Samples samples = sampled(mesh, {3000});
  RC_ASSERT(std::abs(samples.points.size() / 3000.0 - 1) < kCount);
  for (std::size_t i = 0; i < samples.points.size(); i += 500)
    RC_ASSERT(std::abs(winding(mesh, samples.points[i]) - 1) < 1e-6);
}

}  // namespace
}  // namespace sunder::geometry
