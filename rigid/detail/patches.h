#pragma once
/// From contact points of sub-steps to impacts of a step.
#include <vector>

#include "rigid/world.h"

namespace sunder::rigid::detail {

/// What one contact point did in one sub-step; `body_a` is the smaller id, the ground is `body_b`.
struct ContactSample {
  BodyId body_a = 0, body_b = 0;
  Vec3 point = Vec3::Zero();
  Vec3 normal = Vec3::Zero();                       ///< from b towards a
  Vec3 arm_a = Vec3::Zero(), arm_b = Vec3::Zero();  ///< from the centres of mass to the point
  double impulse = 0;
  double approach_speed = 0;  ///< before the sub-step
  double patch_size = 0;      ///< points of the pair closer than this are one patch [m]
  int sub_step = 0;
};

struct ContactLog {
  int sub_step = 0;
  std::vector<ContactSample> samples;
};

/// Patches whose approach was faster than `resting_speed`, in order of ids and then of points.
std::vector<Impact> impacts(std::vector<ContactSample> samples, double resting_speed);

}  // namespace sunder::rigid::detail
