#include "mpm/grid.h"

#include <gtest/gtest.h>

namespace {

using namespace sunder;
using namespace sunder::mpm;

const Box domain(Vec3(-1, 0, 2), Vec3(1, 0.5, 2.3));

TEST(Grid, CoversTheDomainWithItsMargin) {
  const Grid grid(domain, 0.1, 4, domain.min());
  const auto base = [&](const Vec3& x) {
    const Vec3 c = grid.to_cells(x);
    return std::array<int, 3>{static_cast<int>(std::floor(c[0] - 0.5)), static_cast<int>(std::floor(c[1] - 0.5)),
                              static_cast<int>(std::floor(c[2] - 0.5))};
  };
  EXPECT_TRUE(grid.holds(base(domain.min() - Vec3::Constant(0.29))));
  EXPECT_TRUE(grid.holds(base(domain.max() + Vec3::Constant(0.29))));
  EXPECT_FALSE(grid.holds(base(domain.min() - Vec3::Constant(0.51))));
  EXPECT_FALSE(grid.holds(base(domain.max() + Vec3::Constant(0.51))));
}

TEST(Grid, NodesLieOnTheLatticeOfTheAnchor) {
  const Vec3 anchor(0.013, -0.02, 0.4);
  const Grid grid(domain, 0.1, 2, anchor);
  const Vec3 off = (grid.origin() - anchor) / 0.1;
  for (int a = 0; a < 3; ++a) EXPECT_NEAR(off[a], std::round(off[a]), 1e-12);
}

TEST(Grid, IndicesAreDistinctAndLastAxisIsContiguous) {
  const Grid grid(Box(Vec3::Zero(), Vec3::Ones()), 0.5, 1, Vec3::Zero());
  std::vector<bool> seen(grid.nodes().size(), false);
  for (int i = 0; i < grid.size(0); ++i)
    for (int j = 0; j < grid.size(1); ++j)
      for (int k = 0; k < grid.size(2); ++k) {
        ASSERT_LT(grid.index(i, j, k), seen.size());
        EXPECT_FALSE(seen[grid.index(i, j, k)]);
        seen[grid.index(i, j, k)] = true;
      }
  EXPECT_EQ(grid.index(1, 1, 1) + 1, grid.index(1, 1, 2));
}

TEST(Grid, MomentumBecomesVelocityAndEmptyNodesRest) {
  Grid grid(Box(Vec3::Zero(), Vec3::Ones()), 0.5, 1, Vec3::Zero());
  grid.node(0) = Node(2, 4, 6, 2);
  grid.node(1) = Node(1e-300, 0, 0, 1e-300);  // the rim of a kernel: too light to divide by
  grid.momentum_to_velocity();
  EXPECT_EQ(Vec3(grid.node(0).head<3>()), Vec3(1, 2, 3));
  EXPECT_EQ(grid.node(1), Node::Zero());
  EXPECT_EQ(grid.node(2), Node::Zero());
  grid.clear();
  for (const Node& node : grid.nodes()) EXPECT_EQ(node, Node::Zero());
}

}  // namespace
