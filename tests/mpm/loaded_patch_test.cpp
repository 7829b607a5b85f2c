#include "mpm/loaded_patch.h"

#include <gtest/gtest.h>

#include "tests/mpm/bodies.h"
#include "tests/mpm/free_body.h"

namespace {

using namespace sunder;
using namespace sunder::mpm;

constexpr double spacing = 0.004, h = 2 * spacing;

Continuum slab(double cell_size = h) {
  const fixture::Body body = fixture::plate(spacing, 0);
  return {body.points, std::pow(spacing, 3), fixture::dust(1000),
          fixture::continuum_settings(cell_size, 1, Vec3::Zero())};
}

void displace(Continuum& body, int id, const Vec3& by) {
  PointState p = body.point(id);
  p.displacement = by;
  body.set_point(id, p);
}

void displace_all(Continuum& body, const Vec3& by) {
  for (int id = 0; id < body.size(); ++id) displace(body, id, by);
}

const Vec3 top(0, 0.01, 0);

TEST(LoadedPatch, ImpulseArrivesWholeAndAlongTheNormal) {
  Continuum body = slab();
  const LoadedPatch patch(body, top, Vec3::UnitY(), 1.5 * h);
  body.advance(0);
  patch.push(3.5, body);
  body.update_grid();
  const auto motion = body.finish();
  EXPECT_LT((body.momentum(motion) - Vec3(0, -3.5, 0)).norm(), 1e-12);
  // The lattice is symmetric about the axis of the load; a step of 1 s lets the points drift along it.
  EXPECT_LT(body.angular_momentum(motion).norm(), 1e-12);
}

TEST(LoadedPatch, IndentationIsTheRigidDisplacementAgainstTheNormal) {
  Continuum body = slab();
  const LoadedPatch patch(body, top, Vec3::UnitY(), 1.5 * h);
  EXPECT_EQ(patch.indentation(body), 0);
  displace_all(body, Vec3(0.3, -2e-5, 0.1));
  EXPECT_NEAR(patch.indentation(body), 2e-5, 1e-18);
}

TEST(LoadedPatch, HoldsTheMaterialBelowTheContactOnly) {
  Continuum body = slab();
  const double radius = 1.5 * h, depth = 0.6 * radius + 0.5 * h;
  const LoadedPatch patch(body, top, Vec3::UnitY(), radius);
  for (int id = 0; id < body.size(); ++id) {
    displace(body, id, Vec3(0, -1, 0));
    const double weight = patch.indentation(body);
    displace(body, id, Vec3::Zero());
    const Vec3 x = body.material_position(id);
    const double off = std::hypot(x[0], x[2]);
    if (off < radius && top[1] - x[1] <= depth) {
      EXPECT_GT(weight, 0);
    } else {
      EXPECT_EQ(weight, 0);
    }
  }
}

TEST(LoadedPatch, FallsBackToTheNearestParticle) {
  Continuum body = slab();
  const LoadedPatch patch(body, {0.001, 0.1, 0.001}, Vec3::UnitY(), 1e-6);
  displace(body, 0, Vec3(0, -1, 0));
  EXPECT_EQ(patch.indentation(body), 0);
  displace_all(body, Vec3(0, -1, 0));
  EXPECT_EQ(patch.indentation(body), 1);
}

TEST(LoadedPatch, LetsGoOfWhatEscaped) {
  Continuum body = slab();
  LoadedPatch patch(body, top, Vec3::UnitY(), 1.5 * h);
  for (int id = 0; id < body.size(); ++id)
    displace(body, id, body.material_position(id)[0] > 0 ? Vec3(0, 100, 0) : Vec3(0, -1e-5, 0));
  body.follow(Box(Vec3::Constant(-1), Vec3::Constant(1)));
  body.advance(0);
  EXPECT_TRUE(patch.drop_escaped(body));
  EXPECT_NEAR(patch.indentation(body), 1e-5, 1e-18);
  body.follow(Box(Vec3::Constant(5), Vec3::Constant(6)));
  for (int id = 0; id < body.size(); ++id)
    if (!body.escaped(id)) displace(body, id, Vec3::Zero());  // a change asks for sorting
  body.advance(0);
  EXPECT_EQ(body.escapes(), body.size());
  EXPECT_FALSE(patch.drop_escaped(body));
}

}  // namespace
