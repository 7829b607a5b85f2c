#pragma once
/// Where a driven body is at what time.
#include <vector>

#include "core/types.h"

namespace sunder::pipeline {

struct Keyframe {
  double time = 0;  ///< [s]
  Pose pose;        ///< of the body's anchor
};

/// In order of time, the first at 0. Between keyframes positions move evenly and orientations turn evenly along the
/// shorter way (slerp); after the last the body stands still.
using MotionPath = std::vector<Keyframe>;

/// Errors: none; the path must not be empty.
Pose pose_at(const MotionPath& path, double time);

}  // namespace sunder::pipeline
