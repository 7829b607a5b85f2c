#include "pipeline/lifecycle.h"

#include <gtest/gtest.h>

namespace sunder::pipeline {
namespace {

TEST(Lifecycle, ClassesFollowTheSharesOfTheScene) {
  FractureSettings settings;
  EXPECT_EQ(size_class(0.01, settings), SizeClass::tiny);
  EXPECT_EQ(size_class(0.05, settings), SizeClass::small);
  EXPECT_EQ(size_class(0.2, settings), SizeClass::large);
  EXPECT_EQ(size_class(0.98, settings), SizeClass::nearly_whole);
  EXPECT_EQ(size_class(1, settings), SizeClass::nearly_whole);
  settings.tiny_volume = 0.001;
  settings.small_volume = 0.001;
  EXPECT_EQ(size_class(0.002, settings), SizeClass::large);
}

TEST(Lifecycle, CollisionGetsFinerWithTheClass) {
  int parts = 0;
  for (const SizeClass size : {SizeClass::tiny, SizeClass::small, SizeClass::large, SizeClass::nearly_whole}) {
    EXPECT_GT(collision_detail(size).max_parts, parts) << name_of(size);
    parts = collision_detail(size).max_parts;
  }
}

TEST(Lifecycle, WhatIsTinyStaysWholeUnlessTheSceneSaysOtherwise) {
  FractureSettings settings;
  EXPECT_EQ(minimum_volume(settings), settings.tiny_volume);
  settings.minimum_volume = 0.001;
  EXPECT_EQ(minimum_volume(settings), 0.001);
}

}  // namespace
}  // namespace sunder::pipeline
