#include "crack/time_field.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>

#include "crack/detail/index_table.h"
#include "crack/detail/spline_stencil.h"

namespace sunder::crack {

using detail::IndexTable;
using detail::SplineStencil;

namespace {

constexpr double least_weight = 1e-6;  // of a node: below it, its means are rounding
constexpr double least_support = 0.2;  // sum of the weights of the nodes with data
constexpr double flat = 1e-3;          // variance across a plane over the variance within
constexpr double narrow = 1e-2;        // variance across a line over the variance along it
constexpr double well_conditioned = 1e-2;

struct Solution {
  Vec3 gradient, open;
};

/// Solves moment * g = right in the directions that the nodes span; nothing when those are fewer than two.
std::optional<Solution> spanned_solution(const Mat3& moment, const Vec3& right) {
  const double mean = moment.trace() / 3;
  if (!(mean > 0)) return std::nullopt;
  if (moment.determinant() > well_conditioned * mean * mean * mean)
    return Solution{moment.inverse() * right, Vec3::Zero()};
  Eigen::SelfAdjointEigenSolver<Mat3> eigen;
  eigen.computeDirect(moment);
  const Vec3 values = eigen.eigenvalues();
  if (values[1] < narrow * values[2]) return std::nullopt;
  if (values[0] >= flat * values[2]) return Solution{moment.inverse() * right, Vec3::Zero()};
  // The closed form of the eigenvectors is good to 1e-8 only. Any basis of the plane will do, and what it is off the
  // plane enters squared.
  const Vec3 open = eigen.eigenvectors().col(0).normalized();
  Eigen::Matrix<double, 3, 2> basis;
  basis.col(0) = open.unitOrthogonal();
  basis.col(1) = open.cross(basis.col(0));
  const Eigen::Matrix2d within = basis.transpose() * moment * basis;
  return Solution{basis * (within.inverse() * (basis.transpose() * right)), open};
}

}  // namespace

TimeField::TimeField(const std::vector<Vec3>& points, const std::vector<double>& times, double spacing)
    : spacing_(spacing) {
  auto index = std::make_shared<IndexTable>();
  for (std::size_t p = 0; p < points.size(); ++p) {
    if (!(times[p] >= 0)) continue;
    SplineStencil(points[p], spacing).for_each([&](std::uint64_t key, double w) {
      const int n = index->insert(key);
      if (n == static_cast<int>(nodes_.size())) nodes_.emplace_back();
      Node& node = nodes_[n];
      node.weight += w;
      node.time += w * times[p];
      node.position += w * points[p];
    });
  }
  index_ = std::move(index);
  for (Node& node : nodes_) {
    if (node.weight < least_weight) continue;
    node.time /= node.weight;
    node.position /= node.weight;
  }
}

std::optional<TimeField::Sample> TimeField::at(const Vec3& x) const {
  double total = 0, time = 0;
  Vec3 first = Vec3::Zero(), times_offset = Vec3::Zero();
  Mat3 second = Mat3::Zero();
  int reference = -1;
  SplineStencil(x, spacing_).for_each([&](std::uint64_t key, double w) {
    const int n = index_->find(key);
    if (n < 0 || nodes_[n].weight < least_weight) return;
    if (reference < 0) reference = n;
    const double t = nodes_[n].time - nodes_[reference].time;
    const Vec3 r = nodes_[n].position - x;
    total += w;
    time += w * t;
    first += w * r;
    second += w * r * r.transpose();
    times_offset += w * t * r;
  });
  if (total < least_support) return std::nullopt;
  const Mat3 moment = second - first * first.transpose() / total;
  const std::optional<Solution> fit = spanned_solution(moment, times_offset - first * (time / total));
  if (!fit) return std::nullopt;
  const double here = nodes_[reference].time + (time - fit->gradient.dot(first)) / total;
  return Sample{here, fit->gradient, fit->open};
}

}  // namespace sunder::crack
