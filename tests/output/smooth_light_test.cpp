/// The filter of the light in stills.
#include "output/detail/smooth_light.h"

#include <cmath>

#include <gtest/gtest.h>

#include "core/random.h"

namespace sunder::output::detail {
namespace {

constexpr int kSize = 64;

std::size_t place(int column, int row) { return static_cast<std::size_t>(row * kSize + column); }

/// A level surface under noise of standard deviation 0.1 about a light of 1 on the left and 3 on the right; the right
/// half is another surface if `two`.
std::vector<Pixel> noisy(bool two) {
  std::vector<Pixel> pixels(kSize * kSize);
  for (int row = 0; row < kSize; ++row)
    for (int column = 0; column < kSize; ++column) {
      Pixel& pixel = pixels[place(column, row)];
      const bool right = column >= kSize / 2;
      const auto noise = static_cast<float>(std::sqrt(12.0) * (random_unit(1, 0, place(column, row)) - 0.5));
      pixel.light = Rgb::Constant((right ? 3.0f : 1.0f) + 0.1f * noise);
      pixel.variance = 0.01f;
      pixel.surface = two && right ? 4 : 2;
      pixel.normal = Vec3f::UnitY();
      pixel.point = Vec3f(static_cast<float>(column), 0, static_cast<float>(row)) / kSize;
    }
  return pixels;
}

struct Spread {
  double mean, deviation;
};

Spread spread(const std::vector<Pixel>& pixels, int from, int to) {
  double sum = 0, square = 0, count = 0;
  for (int row = 0; row < kSize; ++row)
    for (int column = from; column < to; ++column) {
      const double light = pixels[place(column, row)].light.mean();
      sum += light;
      square += light * light;
      ++count;
    }
  return {sum / count, std::sqrt(square / count - sum * sum / (count * count))};
}

TEST(SmoothLight, TakesNoiseAndLeavesLight) {
  std::vector<Pixel> pixels = noisy(true);
  const Spread before = spread(pixels, 0, kSize / 2);
  smooth_light(pixels, kSize, kSize);
  const Spread after = spread(pixels, 0, kSize / 2);
  EXPECT_LT(after.deviation, before.deviation / 5);
  EXPECT_NEAR(after.mean, before.mean, 0.005) << "a twentieth of the noise";
}

TEST(SmoothLight, DoesNotCrossBordersOfSurfacesNorOfShadows) {
  for (const bool two : {true, false}) {
    std::vector<Pixel> pixels = noisy(two);
    smooth_light(pixels, kSize, kSize);
    // A step of twenty standard deviations is no noise; a little of it may leak where nothing but light tells apart.
    EXPECT_NEAR(spread(pixels, kSize / 2 - 1, kSize / 2).mean, 1, two ? 0.02 : 0.1);
    EXPECT_NEAR(spread(pixels, kSize / 2, kSize / 2 + 1).mean, 3, two ? 0.02 : 0.1);
  }
}

TEST(SmoothLight, LeavesMixedPixelsAndPixelsOfOtherDirectionsAlone) {
  std::vector<Pixel> pixels = noisy(true);
  pixels[place(10, 10)].surface = Pixel::kMixed;
  pixels[place(10, 10)].light = Rgb::Constant(100);
  pixels[place(20, 20)].normal = Vec3f::UnitX();
  pixels[place(20, 20)].light = Rgb::Constant(100);
  smooth_light(pixels, kSize, kSize);
  EXPECT_EQ(pixels[place(10, 10)].light.mean(), 100);
  EXPECT_EQ(pixels[place(20, 20)].light.mean(), 100);
  EXPECT_NEAR(spread(pixels, 0, 1).mean, 1, 0.02);
  EXPECT_LT(pixels[place(11, 10)].light.mean(), 1.2);
  EXPECT_LT(pixels[place(21, 20)].light.mean(), 1.2);
}

}  // namespace
}  // namespace sunder::output::detail
