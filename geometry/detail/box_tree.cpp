#include "geometry/detail/box_tree.h"

#include <numeric>

namespace sunder::geometry::detail {
namespace {

constexpr int kLeaf = 4;

}  // namespace

BoxTree::BoxTree(const std::vector<Vec3>& vertices, const std::vector<Triangle>& faces) : items_(faces.size()) {
  std::iota(items_.begin(), items_.end(), 0);
  boxes_.resize(faces.size());
  for (std::size_t i = 0; i < faces.size(); ++i) {
    const Vec3 &a = vertices[faces[i][0]], &b = vertices[faces[i][1]], &c = vertices[faces[i][2]];
    boxes_[i] = Box(a.cwiseMin(b).cwiseMin(c), a.cwiseMax(b).cwiseMax(c));
  }
  if (faces.empty()) return;
  nodes_.reserve(faces.size());
  nodes_.push_back({});
  split(0, 0, static_cast<int>(faces.size()));
  std::vector<Box> sorted(boxes_.size());
  for (std::size_t i = 0; i < items_.size(); ++i) sorted[i] = boxes_[items_[i]];
  boxes_ = std::move(sorted);
}

// While the tree is being built the boxes are in the order of the faces.
void BoxTree::split(int node, int begin, int end) {
  Box box, centres;
  for (int i = begin; i < end; ++i) {
    box.extend(boxes_[items_[i]]);
    centres.extend(boxes_[items_[i]].center());
  }
  nodes_[node] = {box, begin, end - begin};
  if (end - begin <= kLeaf) return;
  int axis = 0;
  centres.diagonal().maxCoeff(&axis);
  const int middle = (begin + end) / 2;
  const auto below = [&](int a, int b) {
    const double x = boxes_[a].min()[axis] + boxes_[a].max()[axis], y = boxes_[b].min()[axis] + boxes_[b].max()[axis];
    return x != y ? x < y : a < b;
  };
  std::nth_element(items_.begin() + begin, items_.begin() + middle, items_.begin() + end, below);
  const int child = static_cast<int>(nodes_.size());
  nodes_.resize(nodes_.size() + 2);
  nodes_[node].first = child;
  nodes_[node].count = 0;
  split(child, begin, middle);
  split(child + 1, middle, end);
}

TriangleTest::TriangleTest(const Vec3& a, const Vec3& b, const Vec3& c)
    : box_(a.cwiseMin(b).cwiseMin(c), a.cwiseMax(b).cwiseMax(c)), origin_(a), normal_((b - a).cross(c - a)) {
  constexpr double kRounding = 1e-14, kSliver = 1e-6;
  const Vec3 corners[3] = {a, b, c};
  const double diagonal = box_.diagonal().norm(), area = normal_.norm();
  // The thinner the triangle, the less its computed normal says; of a needle only the box is used.
  turn_ = kRounding * diagonal * diagonal / area;
  const bool needle = !(turn_ < kSliver);
  if (needle) turn_ = 0;
  normal_ = needle ? Vec3(Vec3::Zero()) : Vec3(normal_ / area);
  for (int k = 0; k < 3; ++k) {
    const Vec3 &from = corners[k], &to = corners[(k + 1) % 3];
    outward_[k] = (to - from).cross(normal_).normalized();
    height_[k] = std::max(outward_[k].dot(from - a), outward_[k].dot(to - a));
  }
  margin_ = 2 * turn_ * diagonal + kRounding * (diagonal + a.norm());
}

}  // namespace sunder::geometry::detail
