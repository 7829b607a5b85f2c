#include "pipeline/quality.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

namespace sunder::pipeline {
namespace {

TEST(Quality, LevelsHaveNames) {
  for (const char* name : {"draft", "preview", "final"}) {
    const auto quality = quality_of(name);
    ASSERT_TRUE(quality) << name;
    EXPECT_EQ(name_of(*quality), name);
    EXPECT_EQ(Quality::of(quality->particles), *quality) << "a level is the number of its particles";
  }
}

TEST(Quality, NothingElseIsOne) {
  for (const char* text : {"", "finl", "499", "2000001", "20000.5", "20k", "-6000", "99999999999"})
    EXPECT_FALSE(quality_of(text)) << text;
}

RC_GTEST_PROP(Quality, NumbersAreReadBack, ()) {
  const Quality quality = Quality::of(*rc::gen::inRange(Quality::least_particles, Quality::most_particles));
  const auto read = quality_of(name_of(quality));
  RC_ASSERT(read.has_value());
  RC_ASSERT(*read == quality);
}

RC_GTEST_PROP(Quality, FinerIsNeverSlackerElsewhere, ()) {
  const int a = *rc::gen::inRange(Quality::least_particles, Quality::most_particles);
  const int b = *rc::gen::inRange(a, Quality::most_particles);
  RC_ASSERT(Quality::of(a).rigid_rate <= Quality::of(b).rigid_rate);
}

}  // namespace
}  // namespace sunder::pipeline
