#include "output/detail/render.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <tbb/parallel_for.h>

#include "output/detail/samples.h"

namespace sunder::output::detail {
namespace {

constexpr int kTile = 16;
constexpr int kEdgeFactor = 4;            // samples of a mixed pixel of visible contrast over those of others
constexpr float kVisible = 0.04f;         // contrast in [0, 1]
constexpr float kStraightNormal = 0.97f;  // length of the mean normal under which a pixel is an edge

class Tile {
 public:
  Tile(const View& view, int left, int top) : view_(view), left_(left), top_(top) {
    width_ = std::min(kTile, view.width - left);
    height_ = std::min(kTile, view.height - top);
  }

  void render(std::vector<Pixel>& pixels) {
    std::vector<int> all(static_cast<std::size_t>(width_ * height_)), more;
    std::iota(all.begin(), all.end(), 0);
    const std::vector<Sample> samples = taken(all, 0, view_.samples);
    const auto of_pixel = [&](int pixel) {
      const auto count = static_cast<std::size_t>(view_.samples);
      return std::span(samples).subspan(static_cast<std::size_t>(pixel) * count, count);
    };
    for (const int pixel : all) {
      if (!is_mixed(of_pixel(pixel))) {
        pixels[place(pixel)] = uniform(of_pixel(pixel));
      } else {
        pixels[place(pixel)].own = mean(of_pixel(pixel));
        if (contrast(of_pixel(pixel)) > kVisible) more.push_back(pixel);
      }
    }
    const std::vector<Sample> others = taken(more, view_.samples, kEdgeFactor * view_.samples);
    const auto count = static_cast<std::size_t>((kEdgeFactor - 1) * view_.samples);
    for (std::size_t i = 0; i < more.size(); ++i) {
      Rgb& own = pixels[place(more[i])].own;
      own = (own + (kEdgeFactor - 1) * mean(std::span(others).subspan(i * count, count))) / kEdgeFactor;
    }
  }

 private:
  static Rgb seen(const Sample& sample) { return bounded(sample.own + sample.colour * sample.light); }

  /// One very bright sample must not show as a speck.
  static Rgb bounded(const Rgb& radiance) { return radiance.min(4); }

  static Rgb mean(std::span<const Sample> samples) {
    Rgb sum = Rgb::Zero();
    for (const Sample& sample : samples) sum += seen(sample);
    return sum / static_cast<float>(samples.size());
  }

  /// Of the samples' luminance, as a picture can show it: in [0, 1].
  static float contrast(std::span<const Sample> samples) {
    float low = 1, high = 0;
    for (const Sample& sample : samples) {
      const float luminance = seen(sample).mean();
      low = std::min(low, luminance / (1 + luminance));
      high = std::max(high, luminance / (1 + luminance));
    }
    return high - low;
  }

  std::size_t place(int pixel) const {
    return static_cast<std::size_t>((top_ + pixel / width_) * view_.width + left_ + pixel % width_);
  }

  /// Samples number `first` up to `last` of each pixel, shaded.
  std::vector<Sample> taken(const std::vector<int>& pixels, int first, int last) const {
    std::vector<Sample> samples;
    samples.reserve(pixels.size() * static_cast<std::size_t>(last - first));
    for (const int pixel : pixels)
      for (int i = first; i < last; ++i) {
        Sample sample;
        sample.random = {place(pixel), i};
        // A tent two pixels wide: neighbours overlap, which makes edges smooth.
        const auto [a, b] = sample.random.pair(RandomPairs::lens);
        const Eigen::Vector2d at(left_ + pixel % width_ + 0.5 + tent(a), top_ + pixel / width_ + 0.5 + tent(b));
        sample.direction =
            view_.camera.direction({2 * at.x() / view_.width - 1, 1 - 2 * at.y() / view_.height}).cast<float>();
        samples.push_back(sample);
      }
    follow(view_, samples);
    illuminate(view_, samples);
    return samples;
  }

  static double tent(float x) { return x < 0.5f ? std::sqrt(2 * x) - 1 : 1 - std::sqrt(2 - 2 * x); }

  static bool is_mixed(std::span<const Sample> samples) {
    Vec3f normal = Vec3f::Zero();
    for (const Sample& sample : samples) {
      if (sample.path != samples[0].path) return true;
      normal += sample.normal;
    }
    return samples[0].lit && normal.norm() < kStraightNormal * static_cast<float>(samples.size());
  }

  static Pixel uniform(std::span<const Sample> samples) {
    Pixel pixel;
    float square = 0, sum = 0;
    for (const Sample& sample : samples) {
      pixel.own += bounded(sample.own);
      pixel.colour += sample.colour;
      pixel.light += sample.light;
      pixel.point += sample.point;
      pixel.normal += sample.normal;
      sum += sample.light.mean();
      square += sample.light.mean() * sample.light.mean();
    }
    const auto count = static_cast<float>(samples.size());
    pixel.own /= count;
    pixel.colour /= count;
    pixel.light /= count;
    pixel.point /= count;
    pixel.normal /= std::max(pixel.normal.norm(), 1e-6f);
    pixel.variance = std::max(0.0f, square / count - sum * sum / (count * count)) / count;
    pixel.surface = samples[0].lit ? samples[0].surface : Pixel::kMixed;
    return pixel;
  }

  const View& view_;
  int left_, top_, width_, height_;
};

}  // namespace

std::vector<Pixel> render(const View& view) {
  std::vector<Pixel> pixels(static_cast<std::size_t>(view.width) * static_cast<std::size_t>(view.height));
  const int across = (view.width + kTile - 1) / kTile, down = (view.height + kTile - 1) / kTile;
  tbb::parallel_for(0, across * down,
                    [&](int tile) { Tile(view, kTile * (tile % across), kTile * (tile / across)).render(pixels); });
  return pixels;
}

}  // namespace sunder::output::detail
