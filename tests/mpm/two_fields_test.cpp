/// Two velocity fields across a crack and the contact between them: problem D6.
#include <cmath>

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "tests/mpm/free_body.h"

namespace {

using namespace sunder;
using namespace sunder::mpm;

constexpr double cell = 0.125;

/// Faces every half cell over the plane n.x = offset, wherever points are.
std::vector<CrackFace> sheet(const Vec3& normal, double offset, const std::function<bool(const Vec3&)>& part = {}) {
  const Vec3 n = normal.normalized(), u = n.unitOrthogonal(), v = n.cross(u);
  std::vector<CrackFace> faces;
  for (int i = -24; i <= 24; ++i)
    for (int j = -24; j <= 24; ++j) {
      const Vec3 x = offset * n + 0.5 * cell * (i * u + j * v);
      if (!part || part(x)) faces.push_back({x, n});
    }
  return faces;
}

/// Dust whose halves move differently.
struct Halves {
  Vec3 normal = Vec3::UnitX();
  double offset = 0.013;
  fixture::FreeBody free;
  bool opened = false;

  Halves(const Vec3& n, const Vec3& before, const Vec3& behind, const Material& material = fixture::dust(1000),
         Spline spline = Spline::quadratic, double time_step = 1e-4)
      : normal(n.normalized()),
        free(points(), std::pow(cell / 2, 3), material,
             fixture::continuum_settings(cell, time_step, Vec3::Constant(0.0371), spline)) {
    for (int id = 0; id < free.body.size(); ++id)
      free.motion[static_cast<std::size_t>(id)].velocity = is_before(id) ? before : behind;
  }
  static std::vector<Vec3> points() { return fixture::block(Vec3::Constant(0.5), cell / 2, 0.2).points; }
  bool is_before(int id) const { return free.body.material_position(id).dot(normal) > offset; }

  void step(double friction) {
    if (!opened) free.body.open(sheet(normal, offset), friction);
    opened = true;
    free.step();
  }
  Vec3 mean(bool before) const {
    Vec3 sum = Vec3::Zero();
    int count = 0;
    for (int id = 0; id < free.body.size(); ++id)
      if (is_before(id) == before) {
        sum += free.motion[static_cast<std::size_t>(id)].velocity;
        ++count;
      }
    return sum / count;
  }
};

const Vec3 oblique[] = {Vec3::UnitX(), Vec3(1, 1, 0), Vec3(1, 2, 3), Vec3(1, 1, 1)};

TEST(TwoFields, SeparatingHalvesDoNotFeelEachOther) {
  // F13: the printed sign of contact would hold them together. No drag at all, for any direction of the crack.
  for (const Vec3& n : oblique)
    for (Spline spline : {Spline::quadratic, Spline::cubic}) {
      const Vec3 away = 2 * n.normalized();
      Halves halves(n, away, -away, fixture::dust(1000), spline);
      halves.step(0.5);
      for (int id = 0; id < halves.free.body.size(); ++id) {
        const Motion& m = halves.free.motion[static_cast<std::size_t>(id)];
        EXPECT_LT((m.velocity - (halves.is_before(id) ? away : Vec3(-away))).norm(), 1e-12);
        EXPECT_LT(m.affine_velocity.norm(), 1e-10);
      }
    }
}

TEST(TwoFields, ApproachingHalvesShareTheirNormalVelocityAndKeepTheirSliding) {
  for (const Vec3& n : oblique) {
    const Vec3 unit = n.normalized(), slide = unit.unitOrthogonal();
    Halves halves(n, -unit + slide, unit - slide);
    const Vec3 before = halves.free.body.momentum(halves.free.motion);
    halves.step(0);
    const double mass = halves.free.body.particle_mass() * halves.free.body.size();
    EXPECT_LT((halves.free.body.momentum(halves.free.motion) - before).norm(), 1e-13 * mass);
    for (int id = 0; id < halves.free.body.size(); ++id) {
      const Vec3 v = halves.free.motion[static_cast<std::size_t>(id)].velocity;
      EXPECT_NEAR(v.dot(slide), halves.is_before(id) ? 1 : -1, 1e-12);
    }
    // Nodes beside the crack stop the approach: the halves have lost some of it, none has turned.
    EXPECT_GT(halves.mean(true).dot(unit), -0.95);
    EXPECT_LE(halves.mean(true).dot(unit), 1e-12);
  }
}

TEST(TwoFields, FrictionTakesItsShareOfTheSlidingAndNoMore) {
  constexpr double friction = 0.3;
  for (const Vec3& n : oblique) {
    const Vec3 unit = n.normalized(), slide = unit.unitOrthogonal();
    for (double sliding : {5.0, 0.01}) {
      Halves halves(n, -unit + sliding * slide, unit - sliding * slide);
      const Vec3 start = halves.mean(true);
      halves.step(friction);
      const Vec3 change = halves.mean(true) - start;
      const double normal = change.dot(unit), tangential = -change.dot(slide);
      EXPECT_GT(normal, 0);
      if (sliding > 1) {
        // Every node takes exactly this share while it slides.
        EXPECT_NEAR(tangential / normal, friction, 1e-12);
      } else {
        EXPECT_LT(tangential / normal, friction);
        EXPECT_LE(tangential, sliding);
      }
    }
  }
}

TEST(TwoFields, NothingChangesWhereBothSidesMoveAlike) {
  const Vec3 v(0.3, -0.2, 0.5);
  Halves halves(Vec3(1, 2, 3), v, v, fixture::rubber());
  for (int n = 0; n < 5; ++n) halves.step(0.3);
  for (const Motion& m : halves.free.motion) EXPECT_LT((m.velocity - v).norm(), 1e-12);
}

TEST(TwoFields, TensionDoesNotCrossTheCrack) {
  // Stretched halves: with one field they pull each other together, with two they part.
  Material material = fixture::rubber();
  const double dt = 0.2 * cell / material.p_wave_speed();
  for (bool open : {false, true}) {
    Halves halves(Vec3::UnitX(), Vec3(0.5, 0, 0), Vec3(-0.5, 0, 0), material, Spline::quadratic, dt);
    for (int n = 0; n < 40; ++n) {
      if (open && n == 0) halves.free.body.open(sheet(halves.normal, halves.offset), 0.3);
      halves.free.step();
    }
    const double apart = halves.mean(true)[0] - halves.mean(false)[0];
    if (open)
      EXPECT_NEAR(apart, 1, 0.02);
    else
      EXPECT_LT(apart, 0.8);
  }
}

TEST(TwoFields, BeyondTheRimOfACrackMaterialHolds) {
  // A crack through one half of the section: the other half keeps the block together.
  Material material = fixture::rubber();
  const double dt = 0.2 * cell / material.p_wave_speed();
  Halves halves(Vec3::UnitX(), Vec3(0.5, 0, 0), Vec3(-0.5, 0, 0), material, Spline::quadratic, dt);
  const auto faces = sheet(halves.normal, halves.offset, [](const Vec3& x) { return x[1] < 0; });
  for (int n = 0; n < 40; ++n) {
    if (n == 0) halves.free.body.open(faces, 0.3);
    halves.free.step();
  }
  double whole = 0, cracked = 0;
  for (int id = 0; id < halves.free.body.size(); ++id) {
    const Vec3 x = halves.free.body.material_position(id);
    const double v = halves.free.motion[static_cast<std::size_t>(id)].velocity[0] * (x[0] > halves.offset ? 1 : -1);
    (x[1] > 0 ? whole : cracked) += v / (0.5 * halves.free.body.size());
  }
  EXPECT_LT(whole, 0.7 * cracked);
}

TEST(TwoFields, StraysAndSortingKeepMomentumAndSides) {
  for (Spline spline : {Spline::quadratic, Spline::cubic}) {
    const Vec3 away(3, 1, 0), spin(0, 0, 2);
    Halves halves(Vec3(1, 0.2, 0.1), away, -away, fixture::dust(1000), spline, 0.01);
    for (int id = 0; id < halves.free.body.size(); ++id)
      halves.free.motion[static_cast<std::size_t>(id)].velocity += spin.cross(halves.free.body.material_position(id));
    Continuum& body = halves.free.body;
    const Vec3 momentum = body.momentum(halves.free.motion), angular = body.angular_momentum(halves.free.motion);
    body.open(sheet(halves.normal, halves.offset), 0);
    body.start(halves.free.motion);
    body.update_grid();
    for (int n = 1; n < 40; ++n) {
      if (n == 20) body.open({{halves.offset * halves.normal, halves.normal}}, 0);
      body.advance(n * 0.01);
      body.update_grid();
    }
    halves.free.motion = body.finish();
    const double mass = body.particle_mass() * body.size();
    EXPECT_LT((body.momentum(halves.free.motion) - momentum).norm(), 1e-12 * mass);
    EXPECT_LT((body.angular_momentum(halves.free.motion) - angular).norm(), 1e-12 * mass);
    EXPECT_GT(halves.mean(true)[0], 2.9);
    EXPECT_LT(halves.mean(false)[0], -2.9);
  }
}

TEST(TwoFields, BitsDoNotDependOnTheNumberOfThreads) {
  const auto after = [](std::size_t threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    Halves halves(Vec3(1, 2, 3), Vec3(-1, 0, 0.4), Vec3(1, 0.2, 0), fixture::rubber());
    for (int n = 0; n < 20; ++n) halves.step(0.3);
    return halves.free.motion;
  };
  const auto one = after(1), two = after(2);
  for (std::size_t n = 0; n < one.size(); ++n) ASSERT_EQ(one[n].velocity, two[n].velocity);
}

}  // namespace
