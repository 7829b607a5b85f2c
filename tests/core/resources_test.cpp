#include "core/resources.h"

#include <vector>

#include <gtest/gtest.h>

namespace sunder {
namespace {

TEST(Resources, ProcessorTimeGoesOnWithWork) {
  const double before = cpu_seconds();
  volatile double sum = 0;
  while (cpu_seconds() < before + 0.01) sum = sum + 1;
  EXPECT_GT(sum, 0);
}

TEST(Resources, PeakMemoryForgetsWhatWasGivenBack) {
  if (!restart_peak_memory()) GTEST_SKIP() << "this system cannot restart the peak";
  const double before = peak_memory_mb();
  { std::vector<char> large(200'000'000, 1); }
  EXPECT_GT(peak_memory_mb(), before + 180);
  ASSERT_TRUE(restart_peak_memory());
  EXPECT_LT(peak_memory_mb(), before + 100);
}

TEST(Resources, MachineIsNamed) {
  const Machine here = machine();
  EXPECT_FALSE(here.processor.empty());
  EXPECT_GE(here.threads, 1);
  EXPECT_GT(here.memory_gb, 0.1);
}

}  // namespace
}  // namespace sunder
