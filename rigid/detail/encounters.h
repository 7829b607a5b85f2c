#pragma once
/// Which bodies can meet, and how finely a step has to be cut so that none passes through another.
#include <memory>
#include <utility>
#include <vector>

#include "rigid/detail/body.h"

namespace sunder::rigid::detail {

/// Index pairs (first < second) of boxes that touch, in order.
std::vector<std::pair<int, int>> touching(const std::vector<Box>& boxes);

/// Bodies that may act on each other in a step, with the fixed ones that they may meet. Groups do not act on each
/// other, so each is taken through the step by itself, as finely as it needs.
struct Group {
  std::vector<Body*> bodies;  ///< in order of their ids
  int sub_steps = 1;
};

/// Groups in which something is awake, in order of their first bodies that are not fixed; the others have nothing to
/// do. After so many equal sub-steps no pair that can meet in this step moves further against each other, in one of
/// them, than the smaller stride of the two, or a share of the larger one. 1 for everything that flies alone, and for
/// crumbs of less than a millionth of the heaviest mass, which would need hundreds.
std::vector<Group> groups(const std::vector<Body*>& bodies, const Body* ground, const Vec3& gravity, double time_step);

/// Depth of the deepest overlap of two bodies per pair of parts that overlap [m].
struct PartOverlap {
  int part_a = 0, part_b = 0;
  double depth = 0;
};
std::vector<PartOverlap> part_overlaps(const Body& a, const Body& b);

/// Boxes of all parts at the present place.
std::vector<Box> part_bounds(const Body& body);

}  // namespace sunder::rigid::detail
