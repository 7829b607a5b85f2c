/// Exactness of the parts of the cut: nodes, their predicates, and divided triangles.
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "core/random.h"
#include "geometry/detail/crack_complex.h"
#include "geometry/detail/predicates.h"
#include "geometry/detail/triangulation.h"
#include "tests/geometry/shapes.h"

namespace sunder::geometry::detail {
namespace {

// Where x = y = 1/3 of the diagonal plane meets a line: no double has that value.
TEST(Points, KnowWhatRoundingHides) {
  // The line from (0, 0, -1) to (1, 1, 2) meets z = 0 at 1/3, 1/3; so does the line from (1, 0, -1) to (-1, 1, 2).
  const std::vector<Vec3> inputs = {{0, 0, -1}, {1, 1, 2}, {1, 0, -1}, {-1, 1, 2}, {-9, -9, 0}, {9, -9, 0}, {0, 9, 0}};
  const Points points(inputs, {{{0, 1}, {4, 5, 6}}, {{2, 3}, {4, 5, 6}}});
  EXPECT_EQ(points.input_count(), 7);
  EXPECT_NEAR(points[7].x(), 1.0 / 3, 0x1p-52);
  EXPECT_EQ(points.compare(0, 7, 8), 0);
  EXPECT_EQ(points.compare(1, 7, 8), 0);
  EXPECT_EQ(points.orientation(2, 7, 8, 0), 0);
  // Moving the far end of one line by one unit in the last place moves its node by a third of that.
  std::vector<Vec3> moved = inputs;
  moved[1].x() = std::nextafter(1.0, 2.0);
  const Points apart(moved, {{{0, 1}, {4, 5, 6}}, {{2, 3}, {4, 5, 6}}});
  EXPECT_EQ(apart.compare(0, 7, 8), 1);
  EXPECT_EQ(apart.compare(0, 8, 7), -1);
  EXPECT_EQ(apart.compare(1, 7, 8), 0);
}

RC_GTEST_PROP(Points, LieOnTheirLineAndPlane, ()) {
  std::vector<Vec3> inputs;
  for (int i = 0; i < 5; ++i) inputs.push_back(arbitrary_vector(1));
  const int from = orientation(inputs[2], inputs[3], inputs[4], inputs[0]);
  const int to = orientation(inputs[2], inputs[3], inputs[4], inputs[1]);
  RC_PRE(from * to < 0);
  const Points points(inputs, {{{0, 1}, {2, 3, 4}}});
  for (int axis = 0; axis < 3; ++axis) RC_ASSERT(points.orientation(axis, 0, 1, 5) == 0);
  const Enclosure at = crossing(inputs[0], inputs[1], inputs[2], inputs[3], inputs[4]);
  RC_ASSERT(at.low <= 1 && at.high >= 0 && at.low <= at.high);
}

RC_GTEST_PROP(Predicates, AreAntisymmetric, ()) {
  const Vec3 a = arbitrary_vector(1), b = arbitrary_vector(1), c = arbitrary_vector(1);
  // Often in the plane but for rounding.
  const Vec3 d = *rc::gen::arbitrary<bool>() ? arbitrary_vector(1) : Vec3(a + 0.3 * (b - a) + 0.6 * (c - a));
  const int sign = orientation(a, b, c, d);
  RC_ASSERT(orientation(b, a, c, d) == -sign);
  RC_ASSERT(orientation(c, d, a, b) == sign);
}

// Random points, joined by segments that do not cross.
RC_GTEST_PROP(Divide, KeepsAreaAndBarriers, ()) {
  const std::uint64_t seed = *rc::gen::arbitrary<std::uint32_t>();
  const int count = *rc::gen::inRange(2, 40);
  std::vector<Vec3> inputs = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  Division division{.corners = {0, 1, 2}, .on_edge = {}, .inside = {}, .barriers = {}};
  // A zigzag from left to right.
  for (int i = 0; i < count; ++i) {
    const double x = 0.5 * (i + random_unit(seed, 1, i)) / count,
                 y = (0.01 + 0.9 * random_unit(seed, 2, i)) * (0.9 - x);
    inputs.push_back({x + 0.01, y, 0});
    division.inside.push_back(i + 3);
    if (i > 0) division.barriers.push_back({i + 2, i + 3, i - 1});
  }
  const Patch patch = divide(Points(inputs, {}), division);
  RC_ASSERT(patch.faces.size() == 2u * division.inside.size() + 1);
  RC_ASSERT(patch.barriers.size() == division.barriers.size());
  // A zigzag encloses nothing.
  RC_ASSERT(patch.cells == 1);
  double area = 0;
  for (const auto& [a, b, c] : patch.faces) area += (inputs[b] - inputs[a]).cross(inputs[c] - inputs[a]).z() / 2;
  RC_ASSERT(std::abs(area - 0.5) < 1e-14);
}

TEST(Divide, PartsTheCellsOfALoop) {
  const std::vector<Vec3> inputs = {{0, 0, 0}, {9, 0, 0}, {0, 9, 0}, {1, 1, 0}, {3, 1, 0}, {1, 3, 0}, {2, 0, 0}};
  const Points points(inputs, {});
  const Division loop{.corners = {0, 1, 2},
                      .on_edge = {{{6}, {}, {}}},
                      .inside = {3, 4, 5},
                      .barriers = {{3, 4, 0}, {4, 5, 1}, {5, 3, 2}}};
  const Patch patch = divide(points, loop);
  EXPECT_EQ(patch.cells, 2);
  for (const BarrierCells& barrier : patch.barriers) EXPECT_NE(barrier.left, barrier.right);
  EXPECT_EQ(patch.barriers[0].left, patch.barriers[1].left);
  EXPECT_EQ(patch.rim.size(), 4u);
  for (const int cell : patch.rim) EXPECT_EQ(cell, patch.barriers[0].right);
}

TEST(Divide, RefusesCrossingBarriers) {
  const std::vector<Vec3> inputs = {{0, 0, 0}, {9, 0, 0}, {0, 9, 0}, {1, 1, 0},
                                    {2, 2, 0}, {1, 2, 0}, {2, 1, 0}, {1.5, 1.5, 0}};
  const Points points(inputs, {});
  const Division crossing{
      .corners = {0, 1, 2}, .on_edge = {}, .inside = {3, 4, 5, 6}, .barriers = {{3, 4, 0}, {5, 6, 1}}};
  EXPECT_THROW(divide(points, crossing), Error);
  const Division through{.corners = {0, 1, 2}, .on_edge = {}, .inside = {3, 4, 7}, .barriers = {{3, 4, 0}}};
  EXPECT_THROW(divide(points, through), Error);
}

TEST(Wedges, FollowEachOtherAroundAnEdge) {
  // Three half planes around the z axis part three regions.
  RegionBoundary regions;
  regions.vertices = {{0, 0, -1}, {0, 0, 1}, {1, 0, 0}, {-1, 1, 0}, {-1, -1, 0}};
  regions.region_count = 3;
  for (int i = 0; i < 3; ++i) regions.faces.push_back({{0, 1, 2 + i}, (i + 2) % 3, i});
  // The normal of (0, 1, x) points to growing angles.
  const CrackComplex complex = crack_complex(regions);
  const Edges edges = edges_of(complex.triangles, 5);
  const Wedges wedges(complex, edges);
  int axis = 0;
  while (edges.end(axis) - edges.begin(axis) != 3) ++axis;
  EXPECT_FALSE(wedges.is_loose(axis));
  EXPECT_FALSE(wedges.repeats_region(axis));
  int corner = 0;
  while (edges.of_face[0][corner] != axis) ++corner;
  EXPECT_EQ(wedges.across({0, 1}, corner), (CrackSide{1, 0}));
  EXPECT_EQ(wedges.across({0, 0}, corner), (CrackSide{2, 1}));
  for (int edge = 0; edge < edges.count(); ++edge) EXPECT_EQ(wedges.is_loose(edge), edge != axis);
  std::swap(regions.faces[0].inside, regions.faces[0].outside);
  const CrackComplex contradicting = crack_complex(regions);
  EXPECT_TRUE(Wedges(contradicting, edges).is_loose(axis));
}

}  // namespace
}  // namespace sunder::geometry::detail
