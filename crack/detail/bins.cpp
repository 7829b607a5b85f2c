#include "crack/detail/bins.h"

#include <cmath>
#include <numeric>

namespace sunder::crack::detail {

namespace {

constexpr double bins_per_point = 64;  // a thin or scattered cloud gets wider bins rather than more of them

std::vector<int> all_indices(std::size_t count) {
  std::vector<int> indices(count);
  std::iota(indices.begin(), indices.end(), 0);
  return indices;
}

double bin_count(const Vec3& extent, double width) { return ((extent / width).array() + 1.0).prod(); }

}  // namespace

PointBins::PointBins(const std::vector<Vec3>& points, double width)
    : PointBins(points, all_indices(points.size()), width) {}

PointBins::PointBins(const std::vector<Vec3>& points, const std::vector<int>& indices, double width) : width_(width) {
  if (indices.empty()) return;
  for (int i : indices) box_.extend(points[i]);
  while (bin_count(box_.sizes(), width_) > bins_per_point * static_cast<double>(indices.size()) + 4096) width_ *= 1.5;
  for (int axis = 0; axis < 3; ++axis) size_[axis] = static_cast<int>(box_.sizes()[axis] / width_) + 1;

  std::vector<int> bin(indices.size());
  start_.assign(static_cast<std::size_t>(size_[0]) * size_[1] * size_[2] + 1, 0);
  for (std::size_t n = 0; n < indices.size(); ++n) {
    const Cell c = cell(points[indices[n]]);
    bin[n] = (c[2] * size_[1] + c[1]) * size_[0] + c[0];
    ++start_[bin[n] + 1];
  }
  std::partial_sum(start_.begin(), start_.end(), start_.begin());
  entries_.resize(indices.size());
  std::vector<int> next(start_.begin(), start_.end() - 1);
  for (std::size_t n = 0; n < indices.size(); ++n) entries_[next[bin[n]]++] = {points[indices[n]], indices[n]};
}

PointBins::Cell PointBins::cell(const Vec3& x) const {
  Cell c;
  for (int axis = 0; axis < 3; ++axis) {
    const double position = std::floor((x[axis] - box_.min()[axis]) / width_);
    c[axis] = static_cast<int>(std::clamp(position, 0.0, static_cast<double>(size_[axis] - 1)));
  }
  return c;
}

std::pair<PointBins::Cell, PointBins::Cell> PointBins::range(const Vec3& x, double radius) const {
  if (entries_.empty()) return {Cell{0, 0, 0}, Cell{-1, -1, -1}};
  return {cell(x - Vec3::Constant(radius)), cell(x + Vec3::Constant(radius))};
}

bool PointBins::any_within(const Vec3& x, double radius) const {
  bool found = false;
  for_each_within(x, radius, [&](int, double) { found = true; });
  return found;
}

void PointBins::scan_row(const Vec3& x, int j, int k, int first, int last, Nearest& best) const {
  const int row = (k * size_[1] + j) * size_[0];
  for (int e = start_[row + first]; e < start_[row + last + 1]; ++e) {
    const double distance = (entries_[e].position - x).norm();
    if (distance < best.distance || (distance == best.distance && entries_[e].index < best.index))
      best = {entries_[e].index, distance};
  }
}

void PointBins::scan_ring(const Vec3& x, const Cell& home, int ring, Nearest& best) const {
  const auto first = [&](int axis) { return std::max(home[axis] - ring, 0); };
  const auto last = [&](int axis) { return std::min(home[axis] + ring, size_[axis] - 1); };
  for (int k = first(2); k <= last(2); ++k)
    for (int j = first(1); j <= last(1); ++j) {
      if (std::abs(k - home[2]) == ring || std::abs(j - home[1]) == ring) {
        scan_row(x, j, k, first(0), last(0), best);
      } else {
        if (home[0] - ring >= 0) scan_row(x, j, k, home[0] - ring, home[0] - ring, best);
        if (home[0] + ring < size_[0]) scan_row(x, j, k, home[0] + ring, home[0] + ring, best);
      }
    }
}

PointBins::Nearest PointBins::nearest(const Vec3& x, double limit) const {
  Nearest best{-1, limit};
  if (entries_.empty()) return best;
  const Cell home = cell(x);
  const double outside = box_.exteriorDistance(x);
  const int rings = std::max({size_[0], size_[1], size_[2]});
  // What lies in a ring not yet seen is farther away than the whole bins between.
  const auto beyond = [&](int ring) { return std::hypot(outside, std::max(0, ring - 1) * width_); };
  for (int ring = 0; ring < rings && beyond(ring) <= best.distance; ++ring) scan_ring(x, home, ring, best);
  return best;
}

}  // namespace sunder::crack::detail
