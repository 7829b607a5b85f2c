#include "output/detail/smooth_light.h"

#include <algorithm>
#include <cmath>

#include <tbb/parallel_for.h>

namespace sunder::output::detail {
namespace {

constexpr std::array<int, 4> kSteps = {1, 2, 4, 8};             // pixels between the taps of each pass
constexpr std::array<float, 2> kKernel = {1.0f / 2, 1.0f / 4};  // of a linear B-spline
constexpr float kDeviations = 5;                                // of the luminance that are taken for noise
constexpr float kPlane = 0.01f;       // distance from the tangent plane, in sizes of the subject
constexpr float kLeastNoise = 0.01f;  // standard deviation below the steps of the picture

struct Filtered {
  Rgb light;
  float variance;
};

class Pass {
 public:
  Pass(const std::vector<Pixel>& pixels, int width, int height, int step)
      : pixels_(pixels), width_(width), height_(height), step_(step) {}

  Filtered at(int column, int row) const {
    const Pixel& centre = pixel(column, row);
    const float deviation = kDeviations * std::sqrt(near_variance(column, row)) + kLeastNoise;
    Rgb sum = Rgb::Zero();
    float weights = 0, variance = 0;
    for (int dy = -1; dy <= 1; ++dy)
      for (int dx = -1; dx <= 1; ++dx) {
        const int x = column + step_ * dx, y = row + step_ * dy;
        if (x < 0 || y < 0 || x >= width_ || y >= height_) continue;
        const Pixel& other = pixel(x, y);
        if (other.surface != centre.surface) continue;
        const float weight = kKernel[static_cast<std::size_t>(std::abs(dx))] *
                             kKernel[static_cast<std::size_t>(std::abs(dy))] * likeness(centre, other, deviation);
        sum += weight * other.light;
        variance += weight * weight * other.variance;
        weights += weight;
      }
    return {sum / weights, variance / (weights * weights)};
  }

 private:
  const Pixel& pixel(int column, int row) const { return pixels_[static_cast<std::size_t>(row * width_ + column)]; }

  /// A few samples tell little of their variance, so that of the neighbours counts too.
  float near_variance(int column, int row) const {
    float sum = 0, count = 0;
    const int surface = pixel(column, row).surface;
    for (int y = std::max(row - 1, 0); y <= std::min(row + 1, height_ - 1); ++y)
      for (int x = std::max(column - 1, 0); x <= std::min(column + 1, width_ - 1); ++x)
        if (const Pixel& other = pixel(x, y); other.surface == surface) {
          sum += other.variance;
          ++count;
        }
    return sum / count;
  }

  static float likeness(const Pixel& a, const Pixel& b, float deviation) {
    float turn = std::max(0.0f, a.normal.dot(b.normal));
    for (int power = 0; power < 4; ++power) turn *= turn;  // to the 16th
    const float plane = std::abs(a.normal.dot(b.point - a.point)) / kPlane;
    const float luminance = std::abs(a.light.mean() - b.light.mean()) / deviation;
    // Falls off like a bell, for less than an exponential.
    const float unlike = 1 + plane * plane + luminance * luminance;
    return turn / (unlike * unlike);
  }

  const std::vector<Pixel>& pixels_;
  int width_, height_, step_;
};

}  // namespace

void smooth_light(std::vector<Pixel>& pixels, int width, int height) {
  std::vector<Filtered> filtered(pixels.size());
  const auto place = [&](int column, int row) { return static_cast<std::size_t>(row * width + column); };
  for (const int step : kSteps) {
    const Pass pass(pixels, width, height, step);
    const auto each_row = [&](const auto& visit) {
      tbb::parallel_for(0, height, [&](int row) {
        for (int column = 0; column < width; ++column)
          if (pixels[place(column, row)].surface != Pixel::kMixed) visit(column, row);
      });
    };
    each_row([&](int column, int row) { filtered[place(column, row)] = pass.at(column, row); });
    each_row([&](int column, int row) {
      pixels[place(column, row)].light = filtered[place(column, row)].light;
      pixels[place(column, row)].variance = filtered[place(column, row)].variance;
    });
  }
}

}  // namespace sunder::output::detail
