/// Cracks in bodies with limbs, holes and cavities stay in the limb that they are in (validation problems C4 and C5).
#include <numbers>

#include <gtest/gtest.h>

#include "tests/crack/shapes.h"

namespace sunder::crack::test {
namespace {

constexpr int n = 32;
constexpr double h = 1.0 / n;
constexpr double slab = 3 * h;

int island_region(const DamageField& field, const Extraction& result, const Vec3& x) {
  std::size_t nearest = 0;
  for (std::size_t i = 0; i < field.points.size(); ++i)
    if ((field.points[i] - x).norm() < (field.points[nearest] - x).norm()) nearest = i;
  return result.region[nearest];
}

TEST(Shell, CutsABallOutOfACube) {
  constexpr double radius = 10 * h;
  const auto r = [](const Vec3& x) { return (x - Vec3::Constant(0.5)).norm(); };
  const DamageField field = cloud(
      unit_cube(), h, everywhere, [&](const Vec3& x) { return std::abs(r(x) - radius) <= slab / 2; }, 0.25);
  const Extraction result = run(field);
  ASSERT_EQ(result.region_count, 2);
  EXPECT_TRUE(closed(result.boundary));
  const int outer = result.region[0], inner = 1 - outer;
  const double ball = 4.0 / 3 * std::numbers::pi * std::pow(radius, 3);
  EXPECT_NEAR(volume(result.boundary, inner), ball, 0.03 * ball);  // C4
  const Topology in = topology(result.boundary, inner), out = topology(result.boundary, outer);
  EXPECT_EQ(in.shells, 1);
  EXPECT_EQ(in.euler, 2);
  EXPECT_EQ(out.shells, 2);
  EXPECT_EQ(out.euler, 4);
}

/// Two legs on a base, `gap` apart; the lattice has eight points across the flat body.
struct Horseshoe {
  double gap;
  Box box{Vec3::Zero(), Vec3(1, 0.25, 1)};
  double left_end() const { return 0.5 - gap / 2; }
  double right_end() const { return 0.5 + gap / 2; }
  bool contains(const Vec3& x) const { return x.x() < left_end() || x.x() > right_end() || x.z() < 0.25; }
  DamageField cloud_with(const Inside& damaged, double jitter = 0) const {
    return cloud(
        box, h, [this](const Vec3& x) { return contains(x); }, damaged, jitter);
  }
};

TEST(Horseshoe, ACrackInOneLegLeavesTheOtherUntouched) {
  for (double gap : {0.5, 2 * h}) {
    const Horseshoe shoe{gap};
    const DamageField field = shoe.cloud_with(
        [&](const Vec3& x) { return x.x() > shoe.right_end() && std::abs(x.z() - 0.65) <= slab / 2; }, 0.1);
    const Extraction result = run(field, shoe.box);
    ASSERT_EQ(result.region_count, 2) << "gap " << gap;
    EXPECT_TRUE(closed(result.boundary));
    const int base = result.region[0];
    EXPECT_NE(island_region(field, result, {0.9, 0.1, 0.9}), base);
    for (std::size_t i = 0; i < field.points.size(); ++i)
      if (field.points[i].x() < 0.5) {
        ASSERT_EQ(result.region[i], base);
      }
    // The left leg as a solid, not only its points.
    for (int a = 0; a < 8; ++a)
      for (int b = 0; b < 16; ++b)
        ASSERT_EQ(region_at(result.boundary, {shoe.left_end() * (a + 0.51) / 8, 0.1234, (b + 0.53) / 16}), base);
  }
}

TEST(Horseshoe, ACrushedLegIsNotTakenByTheSoundOneBesideIt) {
  const Horseshoe shoe{2 * h};
  const DamageField field = shoe.cloud_with([&](const Vec3& x) {
    return x.x() < shoe.left_end() && std::abs(x.z() - 0.65) <= 5.5 * h;  // thicker than the legs are apart
  });
  const Extraction result = run(field, shoe.box);
  ASSERT_EQ(result.region_count, 2);
  EXPECT_TRUE(closed(result.boundary));
  const int top = island_region(field, result, {0.1, 0.1, 0.99});
  ASSERT_NE(top, result.region[0]);
  for (double x : {0.1, 0.3, 0.45})
    for (double z : {0.7, 0.75, 0.8, 0.9, 0.95}) {
      EXPECT_EQ(region_at(result.boundary, {x, 0.1234, z}), top) << x << " " << z;
      EXPECT_EQ(region_at(result.boundary, {1 - x, 0.1234, z}), result.region[0]) << x << " " << z;
    }
}

TEST(Slot, TwoSpacingsWideSeparates) {
  // Legs joined by the base alone; the base is crushed. Only the empty slot is between them: links are 1.5 spacings
  // long.
  const Horseshoe shoe{2 * h};
  const DamageField field =
      shoe.cloud_with([](const Vec3& x) { return x.z() < 0.3 && std::abs(x.x() - 0.5) <= slab / 2; });
  const Extraction result = run(field, shoe.box);
  ASSERT_EQ(result.region_count, 2);
  EXPECT_GT(count(result, FaceKind::interior), 0);
  EXPECT_GT(count(result, FaceKind::extension), 0);
  for (const CrackFace& face : result.faces) {
    Vec3 middle = Vec3::Zero();
    for (const Vec3& x : polygon_of(result, face)) middle += x / static_cast<double>(face.loop.size());
    if (middle.z() > 0.3 + 2 * h && middle.z() < 1) {
      EXPECT_EQ(face.kind, FaceKind::extension);
    }
  }
}

TEST(Slot, NarrowerThanALinkIsBridged) {
  // The stated limit: links are straight, so what is nearer than a link is connected.
  const Horseshoe shoe{2 * h};
  DamageField field = shoe.cloud_with([](const Vec3& x) { return x.z() < 0.3 && std::abs(x.x() - 0.5) <= slab / 2; });
  for (Vec3& x : field.points)
    if (x.x() > 0.5 && x.z() > 0.3) x.x() -= 1.6 * h;  // 3 - 1.6 spacings between the legs' points
  Settings settings;
  settings.close_necks = false;
  EXPECT_EQ(run(field, shoe.box, settings).region_count, 1);
}

DamageField torus(bool second_cut) {
  const auto ring = [](const Vec3& x) {
    return std::abs(std::hypot(x.x() - 0.5, x.y() - 0.5) - 0.35) < 0.12 && std::abs(x.z() - 0.125) < 0.125;
  };
  return cloud({Vec3::Zero(), Vec3(1, 1, 0.25)}, h, ring, [&](const Vec3& x) {
    return std::abs(x.y() - 0.5 - 0.37 * h) <= slab / 2 && (x.x() > 0.5 || second_cut);
  });
}

TEST(Torus, CutOnceIsOnePiece) {
  const Extraction result = run(torus(false), {Vec3::Zero(), Vec3(1, 1, 0.25)});
  EXPECT_EQ(result.region_count, 1);
  EXPECT_TRUE(result.boundary.faces.empty());
  EXPECT_GT(count(result, FaceKind::partial), 0);
}

TEST(Torus, CutTwiceIsTwo) {
  const Extraction result = run(torus(true), {Vec3::Zero(), Vec3(1, 1, 0.25)});
  EXPECT_EQ(result.region_count, 2);
  EXPECT_TRUE(closed(result.boundary));
  EXPECT_NEAR(result.effective_count, 2, 0.02);
}

TEST(Nothing, UndamagedIsOneRegionWithoutFaces) {
  const Extraction result = run(cloud(unit_cube(), 1.0 / 8, everywhere, nowhere));
  EXPECT_EQ(result.region_count, 1);
  EXPECT_EQ(result.region, std::vector<int>(512, 0));
  EXPECT_TRUE(result.faces.empty());
  EXPECT_EQ(result.damaged_share, 0);
  EXPECT_EQ(result.effective_count, 1);
}

TEST(Nothing, AllDamagedIsOneRegionAllLump) {
  const Extraction result = run(cloud(unit_cube(), 1.0 / 8, everywhere, everywhere));
  EXPECT_EQ(result.region_count, 1);
  EXPECT_EQ(result.region, std::vector<int>(512, 0));
  EXPECT_TRUE(result.faces.empty());
  EXPECT_EQ(result.damaged_share, 1);
  EXPECT_EQ(result.lump_share, 1);
}

TEST(Nothing, NoPointsIsOneRegion) {
  DamageField field;
  field.spacing = field.cell_size = 1;
  EXPECT_EQ(run(field).region_count, 1);
}

TEST(Malformed, FieldsAreRefused) {
  DamageField field = cloud(unit_cube(), 0.25, everywhere, nowhere);
  field.damage.pop_back();
  EXPECT_THROW(run(field), Error);
  field = cloud(unit_cube(), 0.25, everywhere, nowhere);
  field.damage[3] = std::nan("");
  EXPECT_THROW(run(field), Error);
  field = cloud(unit_cube(), 0.25, everywhere, nowhere);
  EXPECT_THROW(run(field, Box()), Error);
  field.spacing = 0;
  EXPECT_THROW(run(field), Error);
}

}  // namespace
}  // namespace sunder::crack::test
