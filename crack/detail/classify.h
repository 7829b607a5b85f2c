#pragma once
/// What a medial face is: does damage lie between its two sites?
#include <vector>

#include "core/types.h"
#include "crack/detail/bins.h"

namespace sunder::crack::detail {

/// Answers whether some damaged point lies beside the segment between two sites, at most `reach` spacings away from it.
class DamageBetween {
 public:
  /// In spacings: a sheet of a single layer of points has no gaps that let a segment through.
  static constexpr double reach = 0.75;

  DamageBetween(const std::vector<Vec3>& points, const std::vector<int>& damaged, double spacing);

  bool operator()(const Vec3& a, const Vec3& b) const;

 private:
  const std::vector<Vec3>& points_;
  PointBins bins_;
  double spacing_;
};

}  // namespace sunder::crack::detail
