#pragma once
/// Neighbour search in material space.
#include <algorithm>
#include <array>
#include <vector>

#include "core/types.h"

namespace sunder::mpm {

inline Box box_of(const std::vector<Vec3>& points) {
  Box box;
  for (const Vec3& x : points) box.extend(x);
  return box;
}

/// One bin per cube of material space.
template <class Bin>
class MaterialBins {
 public:
  MaterialBins(const Box& domain, double bin_size) : origin_(domain.min()), bin_size_(bin_size) {
    std::size_t count = 1;
    for (int a = 0; a < 3; ++a) {
      size_[static_cast<std::size_t>(a)] = static_cast<int>(domain.sizes()[a] / bin_size_) + 1;
      count *= static_cast<std::size_t>(size_[static_cast<std::size_t>(a)]);
    }
    bins_.resize(count);
  }

  /// The same bins with nothing in them.
  MaterialBins emptied() const {
    MaterialBins other = *this;
    for (Bin& bin : other.bins_) bin = Bin();
    return other;
  }

  Bin& bin(const Vec3& x) {
    const auto at = index(x);
    return bins_[static_cast<std::size_t>((at[0] * size_[1] + at[1]) * size_[2] + at[2])];
  }

  /// Calls visit(bin) for the bins within `distance` of x, which lies in the domain, until it returns true.
  template <class Bins, class Visit>
  static void visit(Bins& bins, const Vec3& x, double distance, const Visit& visit) {
    const auto low = bins.index(x - Vec3::Constant(distance)), high = bins.index(x + Vec3::Constant(distance));
    // Distance of x from the bins along each axis, squared.
    const auto gap = [&](int axis, int n) {
      const double from = bins.origin_[axis] + n * bins.bin_size_ - x[axis], to = -from - bins.bin_size_;
      const double d = std::max({from, to, 0.0});
      return d * d;
    };
    const double squared = distance * distance;
    for (int i = low[0]; i <= high[0]; ++i) {
      const double gap_x = gap(0, i);
      for (int j = low[1]; j <= high[1]; ++j) {
        const double gap_xy = gap_x + gap(1, j);
        if (gap_xy > squared) continue;
        for (int k = low[2]; k <= high[2]; ++k)
          if (gap_xy + gap(2, k) <= squared &&
              visit(bins.bins_[static_cast<std::size_t>((i * bins.size_[1] + j) * bins.size_[2] + k)]))
            return;
      }
    }
  }

 private:
  std::array<int, 3> index(const Vec3& x) const {
    std::array<int, 3> at;
    for (int a = 0; a < 3; ++a) {
      const std::size_t n = static_cast<std::size_t>(a);
      at[n] = std::clamp(static_cast<int>((x[a] - origin_[a]) / bin_size_), 0, size_[n] - 1);
    }
    return at;
  }

  Vec3 origin_;
  double bin_size_;
  std::array<int, 3> size_;
  std::vector<Bin> bins_;
};

}  // namespace sunder::mpm
