#include "pipeline/motion_path.h"

#include <algorithm>

namespace sunder::pipeline {

Pose pose_at(const MotionPath& path, double time) {
  const auto after = std::upper_bound(path.begin(), path.end(), time,
                                      [](double t, const Keyframe& keyframe) { return t < keyframe.time; });
  if (after == path.begin()) return path.front().pose;
  if (after == path.end()) return path.back().pose;
  const Keyframe &from = *std::prev(after), &to = *after;
  const double share = (time - from.time) / (to.time - from.time);
  return {from.pose.position + share * (to.pose.position - from.pose.position),
          from.pose.orientation.slerp(share, to.pose.orientation)};
}

}  // namespace sunder::pipeline
