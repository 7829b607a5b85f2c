#include <gtest/gtest.h>

#include "validation/moving_bodies.h"

namespace sunder::rigid {
namespace {

using namespace setup;

// A cube of edge `edge` cut into n^3 boxes whose hulls bulge by `bulge` of their edge.
std::vector<BodySetup> cut_cube(double edge, int n, double bulge, const Vec3& centre, int family = 1) {
  std::vector<BodySetup> parts;
  const Vec3 half = Vec3::Constant(edge / n / 2);
  for (int i = 0; i < n * n * n; ++i) {
    const Vec3 cell(i % n, i / n % n, i / n / n);
    BodySetup part = box(half, centre + (cell - Vec3::Constant((n - 1) / 2.0)) * (edge / n));
    part.hulls = {corners_of_box(half * (1 + bulge))};
    part.family = family;
    parts.push_back(part);
  }
  return parts;
}

constexpr double edges[] = {0.01, 0.2, 1};

TEST(Family, OverlapAtBirthPushesNothingApart) {
  for (double edge : edges) {
    for (int n : {2, 3}) {
      World world(weightless());
      for (const BodySetup& part : cut_cube(edge, n, 0.05, Vec3::Zero())) world.add(part);
      double fastest_ever = 0;
      for (int i = 0; i < 480; ++i) {
        EXPECT_TRUE(world.step().empty());
        fastest_ever = std::max(fastest_ever, fastest(world));
      }
      EXPECT_LT(fastest_ever, 1e-6) << edge << " " << n;
      EXPECT_TRUE(world.overlaps().empty());
    }
  }
}

TEST(Family, WithoutAFamilyTheSameOverlapIsReportedAndPushed) {
  World world(weightless());
  for (const BodySetup& part : cut_cube(0.2, 2, 0.05, Vec3::Zero(), 0)) world.add(part);
  const std::vector<World::Overlap> overlaps = world.overlaps();
  ASSERT_GE(overlaps.size(), 12u);  // face neighbours; edges and corners overlap too
  EXPECT_NEAR(overlaps[0].depth, 0.005, 1e-6);
  EXPECT_LT(overlaps[0].body_a, overlaps[0].body_b);
  const double before = world.state(0).pose.position.norm();
  run(world, 0.1);
  EXPECT_GT(world.state(0).pose.position.norm(), before + 1e-3);
}

double potential_energy(const World& world) {
  double sum = 0;
  for (BodyId id : world.bodies()) sum += world.mass(id) * 9.81 * world.state(id).pose.position.y();
  return sum;
}

// Total energy may only fall; one step's fall of all the bodies is what symplectic Euler may add for a moment.
TEST(Family, HeapUnderGravitySlumpsWithoutGainingEnergy) {
  for (double edge : edges) {
    for (int n : {2, 3}) {
      World world(on_ground());
      for (const BodySetup& part : cut_cube(edge, n, 0.05, Vec3(0, 0.55 * edge, 0))) world.add(part);
      const double start = potential_energy(world);
      double mass = 0, most = -1;
      for (BodyId id : world.bodies()) mass += world.mass(id);
      for (int i = 0; i < 960; ++i) {
        world.step();
        most = std::max(most, kinetic_energy(world) + potential_energy(world) - start);
      }
      EXPECT_LT(most / (mass * 9.81 * edge), 0.001) << edge << " " << n;
      EXPECT_LT(fastest(world), 0.05 * std::sqrt(9.81 * edge)) << edge << " " << n;
    }
  }
}

// Parted once, members are ordinary bodies: they collide where their hulls meet.
TEST(Family, ToleranceShrinksAsMembersPart) {
  World world(weightless());
  std::vector<BodySetup> parts = cut_cube(0.2, 2, 0.05, Vec3::Zero());
  BodySetup left = parts[0], right = parts[1];
  right.twist.linear = Vec3(0.5, 0, 0);
  const BodyId a = world.add(left), b = world.add(right);
  run(world, 0.05);
  BodyState back = world.state(b);
  EXPECT_NEAR(back.twist.linear.x(), 0.5, 1e-9);
  back.twist.linear = Vec3(-0.5, 0, 0);
  world.set_state(b, back);
  const std::vector<Impact> hits = run(world, 0.1);
  ASSERT_FALSE(hits.empty());
  // They meet where the hulls touch, 5 mm before the faces of the cut.
  const double gap = world.state(b).pose.position.x() - world.state(a).pose.position.x();
  EXPECT_GE(gap, 0.105 - 1e-4);
  EXPECT_TRUE(world.overlaps().empty());
}

// A newborn may also overlap a stranger that does not belong to its family: what broke it, or the ground.
TEST(Family, NewbornToleratesWhatItIsBornInto) {
  World world(weightless());
  BodySetup stranger = box(Vec3::Constant(0.05), Vec3::Zero());
  world.add(stranger);
  world.step();
  BodySetup child = box(Vec3::Constant(0.05), Vec3(0.098, 0, 0));
  child.family = 3;
  world.add(child);
  run(world, 0.5);
  EXPECT_LT(fastest(world), 1e-6);
}

// D7: a body in the void of a shell whose walls bulge inward into it, on one side or on all.
struct Void {
  const char* what;
  BodySetup inner;
};

TEST(Family, BodyInsideAShellStaysQuiet) {
  const double half = 0.1, wall = 0.02, bulge = 1.05;
  BodySetup shell = box(Vec3::Constant(half), Vec3(0, half, 0), 500);
  shell.hulls.clear();
  for (int axis = 0; axis < 3; ++axis) {
    for (double side : {-1.0, 1.0}) {
      Vec3 size = Vec3::Constant(half), centre = Vec3::Zero();
      size[axis] = wall / 2 * bulge;
      centre[axis] = side * (half - wall / 2 * bulge);
      shell.hulls.push_back(corners_of_box(size, centre));
    }
  }
  shell.family = 1;
  // Without its poles the ball stands on a flat ring.
  BodySetup round = ball(0.04, Vec3(0.01, wall + 0.04 * std::cos(std::numbers::pi / 8), 0.005));
  round.hulls[0].vertices.erase(round.hulls[0].vertices.begin(), round.hulls[0].vertices.begin() + 2);
  for (Void& v : std::vector<Void>{{"ball on the floor", round},
                                   {"box that fills it", box(Vec3::Constant(half - wall), Vec3(0, half, 0))}}) {
    World world(on_ground());
    const BodyId outer = world.add(shell);
    v.inner.family = 1;
    const BodyId id = world.add(v.inner);
    double fastest_ever = 0;
    for (int i = 0; i < 5 * 480; ++i) {
      world.step();
      fastest_ever = std::max(fastest_ever, fastest(world));
    }
    EXPECT_LT(fastest_ever, 1e-3) << v.what;
    EXPECT_LT((world.state(outer).pose.position - shell.pose.position).norm(), 1e-4) << v.what;
    EXPECT_LT((world.state(id).pose.position - v.inner.pose.position).norm(), 1e-4) << v.what;
  }
}

}  // namespace
}  // namespace sunder::rigid
