#pragma once
/// The points of an arrangement: input points and nodes, the points where a line through two input points meets a plane
/// through three. Nodes are rounded once; predicates on them are exact all the same.
#include <array>
#include <vector>

#include "core/types.h"

namespace sunder::geometry::detail {

/// A node by the indices of the input points that define it. The line must cross the plane.
struct Node {
  std::array<int, 2> line;
  std::array<int, 3> plane;
};

class Points {
 public:
  /// Nodes follow the input points. Every node is rounded here, in parallel; the result does not depend on the threads.
  Points(std::vector<Vec3> inputs, std::vector<Node> nodes);

  const Vec3& operator[](int id) const { return positions_[id]; }
  int size() const { return static_cast<int>(positions_.size()); }
  int input_count() const { return size() - static_cast<int>(nodes_.size()); }
  bool is_node(int id) const { return id >= input_count(); }
  const std::vector<Vec3>& positions() const { return positions_; }

  /// Sign of the difference a - b of one coordinate.
  int compare(int axis, int a, int b) const;

  /// +1 when (a, b, c) turn left seen along `axis`, from its tip.
  int orientation(int axis, int a, int b, int c) const;

 private:
  int exact_compare(int axis, int a, int b) const;
  int exact_orientation(int axis, int a, int b, int c) const;

  std::vector<Vec3> positions_;
  std::vector<Node> nodes_;
  std::vector<double> error_;  // of every coordinate of a node
};

/// An interval that holds a real number.
struct Enclosure {
  double low, high;
};

/// Where the line (p, q) crosses the plane (a, b, c): 0 at p, 1 at q. Everything if rounding hides it.
Enclosure crossing(const Vec3& p, const Vec3& q, const Vec3& a, const Vec3& b, const Vec3& c);

}  // namespace sunder::geometry::detail
