/// What may not change the result: doing it twice, the order of the points, a quarter turn (validation problem C9). And
/// what holds for any planar cut.
#include <numeric>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>
#include <tbb/global_control.h>

#include "tests/crack/shapes.h"

namespace sunder::crack::test {
namespace {

constexpr int n = 16;
constexpr double h = 1.0 / n;

/// Two oblique planes that cross, in a jittered cloud: four pieces.
DamageField crossed_planes() {
  const Vec3 a = Vec3(1, 2, 3).normalized(), b = Vec3(3, 1, -2).normalized();
  return cloud(
      unit_cube(), h, everywhere,
      [&](const Vec3& x) {
        const Vec3 d = x - Vec3::Constant(0.5);
        return std::min(std::abs(a.dot(d)), std::abs(b.dot(d))) <= 1.5 * h;
      },
      0.25);
}

TEST(Invariance, TwiceIsTheSameToTheBit) {
  const DamageField field = crossed_planes();
  const Extraction first = run(field), second = run(field);
  EXPECT_EQ(first.region_count, 4);
  EXPECT_EQ(first.region, second.region);
  EXPECT_EQ(first.boundary.vertices, second.boundary.vertices);
  ASSERT_EQ(first.boundary.faces.size(), second.boundary.faces.size());
  for (std::size_t i = 0; i < first.boundary.faces.size(); ++i) {
    EXPECT_EQ(first.boundary.faces[i].loop, second.boundary.faces[i].loop);
    EXPECT_EQ(first.boundary.faces[i].inside, second.boundary.faces[i].inside);
    EXPECT_EQ(first.boundary.faces[i].outside, second.boundary.faces[i].outside);
  }
}

TEST(Invariance, ThreadsDoNotMatter) {
  const DamageField field = crossed_planes();
  const Extraction all = run(field);
  ASSERT_GT(all.sites, 1000);  // two threads get to do something
  for (const std::size_t threads : {1, 2, 3}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    const Extraction some = run(field);
    EXPECT_EQ(some.region, all.region);
    ASSERT_EQ(some.vertices, all.vertices);
    ASSERT_EQ(some.faces.size(), all.faces.size());
    for (std::size_t i = 0; i < all.faces.size(); ++i) ASSERT_EQ(some.faces[i].loop, all.faces[i].loop);
  }
}

TEST(Invariance, SeedMovesVerticesByTheJitterOnly) {
  const DamageField field = crossed_planes();
  Settings settings;
  settings.seed = 2;
  const Extraction first = run(field), second = run(field, unit_cube(), settings);
  EXPECT_EQ(first.region, second.region);
  EXPECT_NE(first.boundary.vertices, second.boundary.vertices);
  for (int region = 0; region < first.region_count; ++region)
    EXPECT_NEAR(volume_in(first.boundary, region, unit_cube()), volume_in(second.boundary, region, unit_cube()),
                10 * settings.jitter);
}

TEST(Invariance, OrderOfThePointsDoesNotMatter) {
  const DamageField field = crossed_planes();
  const Extraction reference = run(field);
  for (std::uint64_t permutation = 0; permutation < 20; ++permutation) {
    std::vector<int> order(field.points.size());
    std::iota(order.begin(), order.end(), 0);
    std::sort(order.begin(), order.end(),
              [&](int a, int b) { return random_word(permutation, 0, a) < random_word(permutation, 0, b); });
    DamageField shuffled = field;
    for (std::size_t i = 0; i < order.size(); ++i) {
      shuffled.points[i] = field.points[order[i]];
      shuffled.damage[i] = field.damage[order[i]];
    }
    const Extraction result = run(shuffled);
    ASSERT_EQ(result.region_count, reference.region_count);
    EXPECT_EQ(result.effective_count, reference.effective_count);
    std::map<int, int> renamed;
    for (std::size_t i = 0; i < order.size(); ++i) {
      const auto entry = renamed.try_emplace(result.region[i], reference.region[order[i]]).first;
      ASSERT_EQ(entry->second, reference.region[order[i]]);
    }
    EXPECT_EQ(static_cast<int>(renamed.size()), reference.region_count);
  }
}

TEST(Invariance, AQuarterTurnGivesTheTurnedPieces) {
  const DamageField field = crossed_planes();
  DamageField turned = field;
  for (Vec3& x : turned.points) x = Vec3(1 - x.y(), x.x(), x.z());
  const Extraction first = run(field), second = run(turned);
  EXPECT_EQ(first.region, second.region);
  for (int region = 0; region < first.region_count; ++region)
    EXPECT_NEAR(volume(first.boundary, region), volume(second.boundary, region), 100 * Settings().jitter);
}

TEST(Invariance, ALatticeTurnedKeepsItsPieces) {
  // Every tie on a lattice is decided by the numbers of the points, not by the last bits of their distances.
  const DamageField field =
      cloud(unit_cube(), h, everywhere, [](const Vec3& x) { return std::abs(x.x() - x.y()) <= 1.6 * h; });
  DamageField turned = field;
  for (Vec3& x : turned.points) x = Vec3(1 - x.y() + 0.1234567, x.x() - 0.7654321, x.z() + 1.0 / 3);
  Box domain = unit_cube();
  domain.translate(Vec3(0.1234567, -0.7654321, 1.0 / 3));
  const Extraction first = run(field), second = run(turned, domain);
  EXPECT_EQ(first.region_count, 2);
  EXPECT_EQ(first.region, second.region);
}

double between(double low, double high) { return low + (high - low) * *rc::gen::inRange(0, 1 << 20) / (1 << 20); }

RC_GTEST_PROP(PlanarCut, ClosedPositiveAndComplete, ()) {
  const double spacing = std::pow(10, between(-3, 1));
  const Vec3 sizes(*rc::gen::inRange(5, 16), *rc::gen::inRange(5, 16), *rc::gen::inRange(5, 16));
  const Vec3 corner(between(-5, 5), between(-5, 5), between(-5, 5));
  const Box box(spacing * corner, spacing * (corner + sizes));
  const Vec3 normal = Vec3(between(-1, 1), between(-1, 1), between(0.01, 1)).normalized();
  const Vec3 through = box.center() + 0.3 * spacing * Vec3(between(-1, 1), between(-1, 1), between(-1, 1)) * 3;
  const double thickness = between(0, 4) * spacing;
  const DamageField field = cloud(
      box, spacing, everywhere, [&](const Vec3& x) { return std::abs(normal.dot(x - through)) <= thickness / 2; },
      between(0, 0.4));
  const Extraction result = run(field, box);

  RC_ASSERT(result.region.size() == field.points.size());
  RC_ASSERT(result.retries <= 2);
  if (result.region_count == 1) {
    RC_ASSERT(result.boundary.faces.empty());
    return;
  }
  RC_ASSERT(closed(result.boundary));
  double sum = 0;
  for (int region = 0; region < result.region_count; ++region) {
    RC_ASSERT(volume(result.boundary, region) > 0);
    sum += volume(result.boundary, region);
  }
  const double filled = filled_box(result.boundary).volume();
  RC_ASSERT(std::abs(sum - filled) < 1e-10 * filled);
  for (const Vec3& x : field.points) RC_ASSERT(filled_box(result.boundary).contains(x));
}

}  // namespace
}  // namespace sunder::crack::test
