#include "pipeline/motion_path.h"

#include <numbers>

#include <gtest/gtest.h>

namespace sunder::pipeline {
namespace {

Quat about_y(double angle) { return Quat(Eigen::AngleAxisd(angle, Vec3::UnitY())); }

const MotionPath path = {{0, {Vec3(0, 1, 0), Quat::Identity()}},
                         {2, {Vec3(4, 1, 0), about_y(std::numbers::pi / 2)}},
                         {3, {Vec3(4, 0, 0), about_y(std::numbers::pi / 2)}}};

TEST(MotionPath, PassesThroughItsKeyframes) {
  for (const Keyframe& keyframe : path) {
    EXPECT_EQ(pose_at(path, keyframe.time).position, keyframe.pose.position);
    EXPECT_LT(pose_at(path, keyframe.time).orientation.angularDistance(keyframe.pose.orientation), 1e-12);
  }
}

TEST(MotionPath, MovesAndTurnsEvenlyInBetween) {
  EXPECT_LT((pose_at(path, 0.5).position - Vec3(1, 1, 0)).norm(), 1e-12);
  EXPECT_LT(pose_at(path, 0.5).orientation.angularDistance(about_y(std::numbers::pi / 8)), 1e-12);
  EXPECT_LT((pose_at(path, 2.25).position - Vec3(4, 0.75, 0)).norm(), 1e-12);
}

TEST(MotionPath, StandsStillAfterItsEnd) {
  EXPECT_EQ(pose_at(path, 100).position, Vec3(4, 0, 0));
  EXPECT_EQ(pose_at(path, -1).position, Vec3(0, 1, 0));
}

}  // namespace
}  // namespace sunder::pipeline
