#include "geometry/detail/inside.h"

#include <cmath>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "geometry/primitives.h"
#include "tests/geometry/shapes.h"

namespace sunder::geometry::detail {
namespace {

// From a ray of light across a room to the smallest normal number: ratios that no count of bins can follow.
RC_GTEST_PROP(InsideTest, BoxesOfAnyProportion, ()) {
  Vec3 size;
  for (int k = 0; k < 3; ++k) size[k] = std::exp2(*rc::gen::inRange(-1020, 200));
  const TriangleMesh mesh = box(size);
  const InsideTest inside(mesh);
  const Vec3 relative(arbitrary_real(-1, 1), arbitrary_real(-1, 1), arbitrary_real(-1, 1));
  const Box around = bounds(mesh);
  const Vec3 point = around.center() + relative.cwiseProduct(around.sizes());
  RC_ASSERT(inside(point) == (relative.cwiseAbs().maxCoeff() < 0.5));
}

TEST(InsideTest, NeedlesAlongEveryAxis) {
  for (int axis = 0; axis < 3; ++axis) {
    Vec3 size = Vec3::Constant(1e-12);
    size[axis] = 1e12;
    const TriangleMesh mesh = box(size);
    const InsideTest inside(mesh);
    EXPECT_TRUE(inside(Vec3(0.3 * size)));
    EXPECT_FALSE(inside(Vec3(0.6 * size)));
  }
}

}  // namespace
}  // namespace sunder::geometry::detail
