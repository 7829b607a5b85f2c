/// Damage that grows: what an extraction found stays in later ones. And when damage reached where.
#include <set>

#include <gtest/gtest.h>

#include "tests/crack/shapes.h"

namespace sunder::crack::test {
namespace {

constexpr int n = 24;
constexpr double h = 1.0 / n;
constexpr double nearly_all = 0.99;  // new sites may come in at the edges of the body

/// A wavy sheet that has grown up to `front` along x, in a jittered cloud.
DamageField grown_to(double front) {
  const auto height = [](const Vec3& x) { return x.z() - 0.5 - 0.08 * std::sin(7 * x.x() + 2 * x.y()); };
  DamageField field = cloud(
      unit_cube(), h, everywhere, [&](const Vec3& x) { return x.x() < front && std::abs(height(x)) < 1.5 * h; }, 0.25);
  for (std::size_t i = 0; i < field.points.size(); ++i)
    field.damage_time.push_back(field.damage[i] > 0 ? field.points[i].x() : -1);
  return field;
}

/// A corner comes out of its cell with the rounding of the order in which the neighbours cut it.
std::int64_t rounded(double x) { return std::llround(1e9 * x); }

using Corners = std::set<std::array<std::int64_t, 3>>;

Corners corners(const Extraction& result, double up_to) {
  Corners set;
  for (const CrackFace& face : result.faces) {
    const std::vector<Vec3> polygon = polygon_of(result, face);
    const auto inside = [&](const Vec3& x) { return unit_cube().contains(x) && x.x() < up_to; };
    if (!std::all_of(polygon.begin(), polygon.end(), inside)) continue;
    for (const Vec3& x : polygon) set.insert({rounded(x.x()), rounded(x.y()), rounded(x.z())});
  }
  return set;
}

/// Share of the corners of one extraction that another one has as well.
double kept(const Corners& before, const Corners& after) {
  int same = 0;
  for (const auto& x : before) same += after.count(x) > 0;
  return static_cast<double>(same) / static_cast<double>(before.size());
}

TEST(History, AGrowingCrackKeepsItsFaces) {
  SilentProgress progress;
  Extraction last;
  last.region.assign(grown_to(0).points.size(), 0);
  Corners before;
  for (const double front : {0.4, 0.55, 0.7, 0.85, 1.1}) {
    const Extraction result = extract(grown_to(front), unit_cube(), {}, progress, &last);
    EXPECT_EQ(result.region_count, front > 1 ? 2 : 1);
    const Corners after = corners(result, 2);
    if (!before.empty()) {
      EXPECT_GE(kept(before, after), nearly_all);
    }
    before = corners(result, front - 4 * h);  // where the sheet ended it may change
    ASSERT_GT(before.size(), 50u);
    last = result;
  }
}

TEST(History, ACrackThatWidensKeepsItsFacesOnlyByTheirAnchors) {
  SilentProgress progress;
  const auto slab = [](double width) {
    return cloud(
        unit_cube(), h, everywhere, [=](const Vec3& x) { return x.z() > 0.45 && x.z() < 0.45 + width; }, 0.25);
  };
  const Extraction thin = extract(slab(3 * h), unit_cube(), {}, progress);
  ASSERT_EQ(thin.region_count, 2);
  const auto before = corners(thin, 2);
  EXPECT_GE(kept(before, corners(extract(slab(7 * h), unit_cube(), {}, progress, &thin), 2)), nearly_all);
  EXPECT_LT(kept(before, corners(extract(slab(7 * h), unit_cube(), {}, progress), 2)), 0.1);
}

TEST(History, FacesKnowWhenDamageReachedThem) {
  const Extraction result = run(grown_to(2));
  int known = 0;
  for (const CrackFace& face : result.faces) {
    if (face.kind != FaceKind::interior) continue;
    Vec3 middle = Vec3::Zero();
    for (const Vec3& x : polygon_of(result, face)) middle += x / static_cast<double>(face.loop.size());
    if (!Box(Vec3::Constant(2 * h), Vec3::Constant(1 - 2 * h)).contains(middle)) continue;
    EXPECT_NEAR(face.damage_time, middle.x(), h);
    ++known;
  }
  EXPECT_GT(known, 300);
}

TEST(History, TheSpacingThatWasUsedIsSaid) {
  EXPECT_EQ(run(grown_to(0.5)).node_spacing, h);  // what `run` asks for
  SilentProgress progress;
  EXPECT_NEAR(extract(grown_to(0.5), unit_cube(), {}, progress).node_spacing, 0.8 * h, 1e-12);
}

TEST(History, AnchorsOfAnotherBodyAreRefused) {
  SilentProgress progress;
  Extraction result = run(grown_to(0.5));
  result.anchors[0].node = 1 << 30;
  EXPECT_THROW(extract(grown_to(0.6), unit_cube(), {}, progress, &result), Error);
  result = run(grown_to(0.5));
  result.region.pop_back();
  EXPECT_THROW(extract(grown_to(0.6), unit_cube(), {}, progress, &result), Error);
}

}  // namespace
}  // namespace sunder::crack::test
