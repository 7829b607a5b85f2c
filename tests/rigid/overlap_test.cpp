#include <limits>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "validation/moving_bodies.h"

namespace sunder::rigid {
namespace {

using namespace setup;

// Depth of the contact search against the separating axis theorem in its plainest form: for convex bodies the depth is
// the least overlap over all face normals and all cross products of edges. With every pair of points taken for an edge
// and every triple for a face this is slow, needs no topology, and adds only axes that can not be better.
class Wedge {
 public:
  Wedge(double size, std::uint64_t stream, std::uint64_t index) {
    for (int i = 0; i < 6; ++i) {
      const auto unit = [&](int k) { return random_unit(stream, static_cast<std::uint64_t>(3 * i + k), index) - 0.5; };
      const Vec3 corner(i % 3 == 1, i % 3 == 2, i / 3);
      points_.push_back(size * (corner - Vec3(1, 1, 1.5) / 3 + 0.3 * Vec3(unit(0), unit(1), unit(2))));
    }
  }

  BodySetup setup(const Pose& pose) const {
    BodySetup body;
    body.hulls.resize(1);
    body.hulls[0].vertices = points_;
    body.pose = pose;
    return body;
  }

  std::vector<Vec3> placed(const Pose& pose) const {
    std::vector<Vec3> result;
    for (const Vec3& x : points_) result.push_back(pose * x);
    return result;
  }

 private:
  std::vector<Vec3> points_;
};

double extent(const std::vector<Vec3>& points, const Vec3& direction) {
  double best = -std::numeric_limits<double>::infinity();
  for (const Vec3& x : points) best = std::max(best, direction.dot(x));
  return best;
}

double depth_along(const std::vector<Vec3>& a, const std::vector<Vec3>& b, const Vec3& axis) {
  if (axis.norm() == 0) return std::numeric_limits<double>::infinity();
  const Vec3 n = axis.normalized();
  return std::min(extent(a, -n) + extent(b, n), extent(a, n) + extent(b, -n));
}

std::vector<Vec3> edges(const std::vector<Vec3>& points) {
  std::vector<Vec3> result;
  for (std::size_t i = 0; i < points.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) result.push_back(points[i] - points[j]);
  return result;
}

double exact_depth(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  double depth = std::numeric_limits<double>::infinity();
  const std::vector<Vec3> of_a = edges(a), of_b = edges(b);
  for (const Vec3& e : of_a) {
    for (const Vec3& f : of_b) depth = std::min(depth, depth_along(a, b, e.cross(f)));
    for (const Vec3& f : of_a) depth = std::min(depth, depth_along(a, b, e.cross(f)));
  }
  for (const Vec3& e : of_b)
    for (const Vec3& f : of_b) depth = std::min(depth, depth_along(a, b, e.cross(f)));
  return depth;
}

// Points on a face may miss the full depth by this much of the radius, as contact.cpp states.
constexpr double depth_tolerance = 0.011;

struct Depths {
  double found, expected, size;

  bool agree() const { return std::abs(found - std::max(expected, 0.0)) <= depth_tolerance * size; }
};

Depths depths_of_wedges(double size, std::uint64_t index) {
  const auto unit = [&](std::uint64_t k) { return random_unit(22, k, index) - 0.5; };
  const Wedge first(size, 23, index), second(size, 24, index);
  const Pose place_a{Vec3(1, 2, 3) * size, random_turn(25, index)};
  const Pose place_b{place_a.position + 1.8 * size * Vec3(unit(0), unit(1), unit(2)), random_turn(26, index)};
  World world(weightless());
  world.add(first.setup(place_a));
  world.add(second.setup(place_b));
  const std::vector<World::Overlap> overlaps = world.overlaps();
  return {overlaps.empty() ? 0 : overlaps[0].depth, exact_depth(first.placed(place_a), second.placed(place_b)), size};
}

RC_GTEST_PROP(Overlap, DepthIsThatOfTheSeparatingAxisTheorem, (std::uint64_t index)) {
  const Depths depths = depths_of_wedges(std::pow(10.0, -3 + 3 * random_unit(21, 0, index)), index);
  RC_CLASSIFY(depths.expected > 0, "overlapping");
  RC_ASSERT(depths.agree());
}

// Here GJK and EPA come to no end, and edges lie deepest in each other: found among 40000.
TEST(Overlap, IsFoundWithoutGjkAndEpa) {
  for (const std::uint64_t index : {2375, 2832, 5703, 10409, 17468, 17815, 20997, 27497}) {
    const Depths depths = depths_of_wedges(1, index);
    EXPECT_TRUE(depths.agree()) << index << ": " << depths.found << " instead of " << depths.expected;
  }
}

}  // namespace
}  // namespace sunder::rigid
