#include "crack/detail/classify.h"

#include <cmath>

namespace sunder::crack::detail {

DamageBetween::DamageBetween(const std::vector<Vec3>& points, const std::vector<int>& damaged, double spacing)
    : points_(points), bins_(points, damaged, spacing), spacing_(spacing) {}

bool DamageBetween::operator()(const Vec3& a, const Vec3& b) const {
  const Vec3 along = b - a;
  const double squared_length = along.squaredNorm();
  const auto beside = [&](const Vec3& x) {
    const double t = (x - a).dot(along) / squared_length;
    return t > 0 && t < 1 && (x - a - t * along).norm() <= reach * spacing_;
  };
  // Balls along the segment, a spacing apart, that cover everything within reach of it.
  const int steps = static_cast<int>(std::ceil(std::sqrt(squared_length) / spacing_));
  const double radius = std::hypot(reach, 0.5) * spacing_;
  bool found = false;
  for (int step = 0; step < steps && !found; ++step)
    bins_.for_each_within(a + (step + 0.5) / steps * along, radius,
                          [&](int i, double) { found = found || beside(points_[i]); });
  return found;
}

}  // namespace sunder::crack::detail
