#pragma once
/// Points sorted into a regular grid of bins: who is near whom, and who is nearest.
#include <array>
#include <utility>
#include <vector>

#include "core/types.h"

namespace sunder::crack::detail {

class PointBins {
 public:
  /// Bins the points with the given indices. `width` [m] is the width of a bin: best near the usual search radius.
  PointBins(const std::vector<Vec3>& points, const std::vector<int>& indices, double width);

  /// Bins all points.
  PointBins(const std::vector<Vec3>& points, double width);

  bool empty() const { return entries_.empty(); }

  /// Calls visit(index, squared distance) for every point at most `radius` away from `x`.
  template <typename Visit>
  void for_each_within(const Vec3& x, double radius, Visit&& visit) const {
    const auto [first, last] = range(x, radius);
    for (int k = first[2]; k <= last[2]; ++k)
      for (int j = first[1]; j <= last[1]; ++j) {
        const int row = (k * size_[1] + j) * size_[0];
        for (int e = start_[row + first[0]]; e < start_[row + last[0] + 1]; ++e) {
          const double squared = (entries_[e].position - x).squaredNorm();
          if (squared <= radius * radius) visit(entries_[e].index, squared);
        }
      }
  }

  bool any_within(const Vec3& x, double radius) const;

  struct Nearest {
    int index = -1;
    double distance = std::numeric_limits<double>::infinity();
  };

  /// The nearest point closer than `limit`, the lowest index among equals; index -1 if there is none.
  Nearest nearest(const Vec3& x, double limit = std::numeric_limits<double>::infinity()) const;

 private:
  using Cell = std::array<int, 3>;

  struct Entry {
    Vec3 position;
    int index;
  };

  Cell cell(const Vec3& x) const;
  std::pair<Cell, Cell> range(const Vec3& x, double radius) const;
  void scan_row(const Vec3& x, int j, int k, int first, int last, Nearest& best) const;
  void scan_ring(const Vec3& x, const Cell& home, int ring, Nearest& best) const;

  Box box_;
  double width_ = 1;
  Cell size_ = {0, 0, 0};
  std::vector<int> start_ = {0};  // per bin, and one more: its first entry
  std::vector<Entry> entries_;    // by bin, then by index
};

}  // namespace sunder::crack::detail
