#include "geometry/poisson_disk.h"

#include <chrono>
#include <cmath>
#include <cstdio>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "core/error.h"
#include "core/random.h"
#include "geometry/load.h"
#include "geometry/mass_properties.h"
#include "geometry/primitives.h"
#include "geometry/side_of.h"
#include "tests/geometry/shapes.h"

namespace sunder::geometry {
namespace {

// The header leaves 1e-6 of the volume; one of thousands of probes may fall there.
constexpr double kCovered = 0.999;

std::vector<Vec3> filled(const TriangleMesh& solid, double radius, std::uint64_t seed = 1) {
  SilentProgress progress;
  return poisson_disk(solid, radius, seed, progress);
}

double nearest(const std::vector<Vec3>& points, const Vec3& x) {
  double best = std::numeric_limits<double>::infinity();
  for (const Vec3& point : points) best = std::min(best, (point - x).squaredNorm());
  return std::sqrt(best);
}

/// The share of random probes inside that are within the radius of a point.
double coverage(const TriangleMesh& solid, const std::vector<Vec3>& points, double radius, int probes) {
  const Box box = bounds(solid);
  std::vector<Vec3> x(probes);
  for (int i = 0; i < probes; ++i) {
    for (int axis = 0; axis < 3; ++axis) {
      x[i][axis] = box.min()[axis] + box.diagonal()[axis] * random_unit(7, axis, i);
    }
  }
  const std::vector<Side> side = side_of(solid, x);
  int inside = 0, covered = 0;
  for (int i = 0; i < probes; ++i) {
    if (side[i] != Side::inside) continue;
    ++inside;
    covered += nearest(points, x[i]) < radius;
  }
  return inside > 0 ? static_cast<double>(covered) / inside : 1;
}

std::string broken(const TriangleMesh& solid, const std::vector<Vec3>& points, double radius, int probes) {
  if (points.empty()) return "no points";
  for (std::size_t i = 0; i < points.size(); ++i) {
    for (std::size_t j = i + 1; j < points.size(); ++j) {
      if (!((points[i] - points[j]).norm() >= radius)) return "two points are too close";
    }
  }
  for (const Side side : side_of(solid, points)) {
    if (side != Side::inside) return "a point is not inside";
  }
  const double share = coverage(solid, points, radius, probes);
  return share >= kCovered ? "" : "covered: " + std::to_string(share);
}

TEST(PoissonDisk, FillsFamiliesOfShapes) {
  for (const TriangleMesh& solid : {box({1, 1, 1}), sphere(0.6, 3), torus(1, 0.3), cup(0.1, 0.006), goblet(0.2, 0.004),
                                    column(3), hollow_sphere(0.6, 0.05, 3)}) {
    const double radius = std::cbrt(mass_properties(solid).volume / 2000);
    EXPECT_EQ(broken(solid, filled(solid, radius), radius, 3000), "");
  }
}

// Parts that no chain of close points joins, and a wall thinner than a radius.
TEST(PoissonDisk, FillsPartsThatAreFarApart) {
  const TriangleMesh two = together(sphere(0.5, 2), moved(sphere(0.5, 2), {10, 0, 0}));
  const std::vector<Vec3> points = filled(two, 0.1);
  EXPECT_EQ(broken(two, points, 0.1, 20000), "");
  const auto left = std::count_if(points.begin(), points.end(), [](const Vec3& x) { return x.x() < 5; });
  EXPECT_NEAR(static_cast<double>(left) / points.size(), 0.5, 0.05);
  const TriangleMesh plate = box({1, 0.01, 1});
  EXPECT_EQ(broken(plate, filled(plate, 0.05), 0.05, 3000), "");
}

// The density of maximal Poisson-disk sampling far from the surface: 0.7 to 0.75 points per radius^3 ("random close
// packing" of balls of half the radius gives 1.22; saturated random adsorption in 3-D fills 0.384, so 0.384 * 6 / pi =
// 0.733, Torquato, Uche and Stillinger 2006). The surface adds some.
TEST(PoissonDisk, HasTheDensityOfRandomAdsorption) {
  const std::vector<Vec3> points = filled(box({1, 1, 1}), 0.04);
  int core = 0;
  for (const Vec3& x : points) core += x.cwiseAbs().maxCoeff() < 0.4;
  EXPECT_NEAR(core * std::pow(0.04, 3) / std::pow(0.8, 3), 0.733, 0.02);
}

TEST(PoissonDisk, RepeatsBitForBit) {
  const TriangleMesh solid = cup(0.1, 0.006);
  EXPECT_EQ(filled(solid, 0.003, 7), filled(solid, 0.003, 7));
  EXPECT_NE(filled(solid, 0.003, 7), filled(solid, 0.003, 8));
}

TEST(PoissonDisk, ARadiusLargerThanTheBodyGivesOnePoint) { EXPECT_EQ(filled(box({1, 1, 1}), 10).size(), 1u); }

TEST(PoissonDisk, RefusesNonsense) {
  EXPECT_THROW(filled(box({1, 1, 1}), 0), Error);
  EXPECT_THROW(filled(box({1, 1, 1}), std::nan("")), Error);
  EXPECT_THROW(filled(box({1, 1, 1}), 1e-4), Error);
  EXPECT_THROW(filled(inside_out(box({1, 1, 1})), 0.1), Error);
  EXPECT_THROW(filled({}, 0.1), Error);
}

TEST(PoissonDisk, StopsWhenAsked) {
  class Stop final : public Progress {
    void report(std::string_view, double) override {}
    bool cancelled() const override { return true; }
  } stop;
  EXPECT_THROW(poisson_disk(box({1, 1, 1}), 0.1, 1, stop), Error);
}

TEST(PoissonDisk, ScannedMesh) {
  const auto file = sample_mesh("bunny00.off");
  if (!std::filesystem::exists(file)) GTEST_SKIP() << file << " is missing";
  const TriangleMesh bunny = load_mesh(file);
  const double radius = std::cbrt(mass_properties(bunny).volume / 5000);
  const auto start = std::chrono::steady_clock::now();
  const std::vector<Vec3> points = filled(bunny, radius);
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  EXPECT_EQ(broken(bunny, points, radius, 5000), "");
  std::printf("bunny: %zu points in %.2f s, %.4f covered\n", points.size(), seconds,
              coverage(bunny, points, radius, 20000));
}

RC_GTEST_PROP(PoissonDisk, AnySolidIsFilled, ()) {
  const TriangleMesh solid = transformed(arbitrary_shape(), arbitrary_rotation(), arbitrary_vector(2));
  const double radius = std::cbrt(mass_properties(solid).volume / *rc::gen::inRange(5, 400));
  RC_ASSERT(broken(solid, filled(solid, radius, *rc::gen::arbitrary<std::uint32_t>()), radius, 2000) == "");
}

}  // namespace
}  // namespace sunder::geometry
