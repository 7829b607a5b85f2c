#include "geometry/detail/mean_value.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace sunder::geometry::detail {
namespace {

using Vec2 = Eigen::Vector2d;

constexpr double kOnBorder = 1e-12;

double cross(const Vec2& a, const Vec2& b) { return a.x() * b.y() - a.y() * b.x(); }

}  // namespace

std::vector<double> mean_value_weights(const std::vector<Vec2>& loop, const Vec2& x) {
  const std::size_t count = loop.size();
  std::vector<Vec2> to(count);
  std::vector<double> distance(count), area(count), dot(count), weight(count, 0);
  double size = 0;
  for (std::size_t i = 0; i < count; ++i) {
    to[i] = loop[i] - x;
    distance[i] = to[i].norm();
    size = std::max(size, (loop[i] - loop[0]).norm());
  }
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t next = (i + 1) % count;
    if (distance[i] <= kOnBorder * size) return weight[i] = 1, weight;
    area[i] = cross(to[i], to[next]);
    dot[i] = to[i].dot(to[next]);
  }
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t next = (i + 1) % count;
    if (dot[i] >= 0 || std::abs(area[i]) > kOnBorder * size * (loop[next] - loop[i]).norm()) continue;
    weight[i] = distance[next] / (distance[i] + distance[next]);
    weight[next] = 1 - weight[i];
    return weight;
  }
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t next = (i + 1) % count, last = (i + count - 1) % count;
    if (area[last] != 0) weight[i] += (distance[last] - dot[last] / distance[i]) / area[last];
    if (area[i] != 0) weight[i] += (distance[next] - dot[i] / distance[i]) / area[i];
  }
  const double sum = std::accumulate(weight.begin(), weight.end(), 0.0);
  for (double& w : weight) w /= sum;
  return weight;
}

}  // namespace sunder::geometry::detail
