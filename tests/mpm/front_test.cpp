#include "mpm/front.h"

#include <gtest/gtest.h>

#include "core/random.h"

namespace {

using namespace sunder;
using namespace sunder::mpm;

constexpr double h = 0.01, wave_speed = 5000;
const FrontSettings settings;
const Vec3 centre = Vec3::Constant(0.5), normal = Vec3::UnitY();
constexpr double late = 1;  ///< when every front has had all the time it needs

CrackFronts one_front() {
  CrackFronts fronts(Box(Vec3::Zero(), Vec3::Ones()), h, wave_speed, settings);
  fronts.add(centre, normal, 0);
  return fronts;
}

Verdict at(const Vec3& offset_in_h, const Vec3& n = normal, double time = late) {
  return one_front().look(centre + h * offset_in_h, n, time).verdict();
}

TEST(CrackFronts, NothingNearLetsACrackNucleate) {
  const CrackFronts none(Box(Vec3::Zero(), Vec3::Ones()), h, wave_speed, settings);
  EXPECT_EQ(none.look(centre, normal, late).verdict(), Verdict::nucleate);
  EXPECT_EQ(at({0, 3.01, 0}), Verdict::nucleate);
  EXPECT_EQ(at({3.01, 0, 0}), Verdict::nucleate);
}

TEST(CrackFronts, BesideTheBandFillsToItsWidthAndShieldsBeyond) {
  EXPECT_EQ(at({0, 0.5, 0}), Verdict::filler);
  EXPECT_EQ(at({0, -0.99, 0}), Verdict::filler);
  EXPECT_EQ(at({0, 1.01, 0}), Verdict::wait);
  EXPECT_EQ(at({0, 2.99, 0}), Verdict::wait);
  EXPECT_EQ(at({1.5, 2, 0}), Verdict::wait);
}

TEST(CrackFronts, AheadAdvancesOnceTheFrontHasHadTheTime) {
  const double arrival = 1.2 * h / (settings.speed * wave_speed);
  EXPECT_EQ(at({1.2, 0, 0}, normal, 0.99 * arrival), Verdict::wait);
  EXPECT_EQ(at({1.2, 0, 0}, normal, 1.01 * arrival), Verdict::advance);
  EXPECT_EQ(at({0, 0.3, 1.2}), Verdict::advance);
  // Ahead but out of reach: a crack may start there by itself.
  EXPECT_EQ(at({1.6, 0, 0}), Verdict::nucleate);
}

TEST(CrackFronts, CracksAtOtherAnglesDoNotSeeEachOther) {
  const double limit = settings.parallel_angle * 3.14159265358979 / 180;
  EXPECT_EQ(at({0, 2, 0}, Vec3(std::sin(limit - 0.01), std::cos(limit - 0.01), 0)), Verdict::wait);
  EXPECT_EQ(at({0, 2, 0}, Vec3(std::sin(limit + 0.01), std::cos(limit + 0.01), 0)), Verdict::nucleate);
  EXPECT_EQ(at({0, 2, 0}, -normal), Verdict::wait) << "a normal has no sign";
}

TEST(CrackFronts, FillerBeforeShieldBeforeAhead) {
  CrackFronts fronts = one_front();
  // A parallel crack two cells above: shields what the first would pull ahead, but does not stop its filler.
  fronts.add(centre + h * Vec3(1.2, 2, 0), normal, 0);
  EXPECT_EQ(fronts.look(centre + h * Vec3(1.2, 0, 0), normal, late).verdict(), Verdict::wait);
  EXPECT_EQ(fronts.look(centre + h * Vec3(0.3, 0.5, 0), normal, late).verdict(), Verdict::filler);
}

TEST(CrackFronts, NewFrontsCanBeAskedAlone) {
  CrackFronts fronts = one_front();
  const int known = fronts.count();
  EXPECT_EQ(fronts.look(centre + h * Vec3(0, 2, 0), normal, late, known).verdict(), Verdict::nucleate);
  fronts.add(centre + h * Vec3(0, 4, 0), normal, 0);
  EXPECT_EQ(fronts.look(centre + h * Vec3(0, 2, 0), normal, late, known).verdict(), Verdict::wait);
}

/// The rules in the order of the header, asking every front.
Verdict plain_verdict(const std::vector<std::pair<Vec3, Vec3>>& fronts, const Vec3& x, const Vec3& n) {
  bool fills = false, shields = false, ahead = false;
  const double tan_ahead = std::tan(settings.ahead_angle * 3.14159265358979323846 / 180);
  const double cos_parallel = std::cos(settings.parallel_angle * 3.14159265358979323846 / 180);
  for (const auto& [position, direction] : fronts) {
    const Vec3 d = (x - position) / h;
    if (d.norm() > settings.shield_radius || std::abs(n.dot(direction)) < cos_parallel) continue;
    const double a = std::abs(d.dot(direction)), b = (d - d.dot(direction) * direction).norm();
    if (a > b * tan_ahead) {
      shields |= a > settings.filler_width;
      fills |= a <= settings.filler_width && b <= 1;
    } else {
      ahead |= d.norm() <= settings.ahead_reach;
    }
  }
  if (fills) return Verdict::filler;
  if (shields) return Verdict::wait;
  return ahead ? Verdict::advance : Verdict::nucleate;
}

TEST(CrackFronts, TheSearchFindsWhatAskingEveryFrontFinds) {
  std::uint64_t drawn = 0;
  const auto random = [&] { return random_unit(4, 4, drawn++); };
  const auto direction = [&] { return Vec3(Vec3(random() - 0.5, random() - 0.5, random() - 0.5).normalized()); };
  CrackFronts fronts(Box(Vec3::Zero(), Vec3::Constant(0.15)), h, wave_speed, settings);
  std::vector<std::pair<Vec3, Vec3>> all;
  for (int n = 0; n < 150; ++n) {
    all.emplace_back(0.15 * Vec3(random(), random(), random()), direction());
    fronts.add(all.back().first, all.back().second, 0);
  }
  std::array<int, 4> seen{};
  for (int n = 0; n < 4000; ++n) {
    const Vec3 x = 0.15 * Vec3(random(), random(), random()), along = direction();
    const Verdict verdict = fronts.look(x, along, late).verdict();
    ASSERT_EQ(verdict, plain_verdict(all, x, along));
    ++seen[static_cast<std::size_t>(verdict)];
  }
  for (int count : seen) EXPECT_GT(count, 100) << "every verdict has to occur";
}

}  // namespace
