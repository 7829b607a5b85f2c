#pragma once
/// Which bodies can meet, and how finely a step has to be cut so that none passes through another.
#include <memory>
#include <utility>
#include <vector>

#include "rigid/detail/body.h"

namespace sunder::rigid::detail {

/// Index pairs (first < second) of boxes that touch, in order.
std::vector<std::pair<int, int>> touching(const std::vector<Box>& boxes);

/// Number of equal sub-steps after which no pair that can meet in this step moves further against each other, in one of
/// them, than the smaller stride of the two (or a share of the larger one). 1 for everything that flies alone, and for
/// crumbs of less than a millionth of the heaviest mass, which would need hundreds.
int sub_steps(const std::vector<Body*>& bodies, const Body* ground, const Vec3& gravity, double time_step);

/// Depth of the deepest overlap of two bodies per pair of parts that overlap [m].
struct PartOverlap {
  int part_a = 0, part_b = 0;
  double depth = 0;
};
std::vector<PartOverlap> part_overlaps(const Body& a, const Body& b);

/// Boxes of all parts at the present place.
std::vector<Box> part_bounds(const Body& body);

}  // namespace sunder::rigid::detail
