#pragma once
/// A hierarchy of boxes around triangles.
#include <algorithm>
#include <cmath>
#include <vector>

#include "geometry/mesh.h"

namespace sunder::geometry::detail {

class BoxTree {
 public:
  BoxTree(const std::vector<Vec3>& vertices, const std::vector<Triangle>& faces);

  /// Calls visit(face) for every face with accept(box of the face), where accept is false for a box only if it is for
  /// every box inside that one.
  template <typename Accept, typename Visit>
  void visit(const Accept& accept, const Visit& visit) const {
    if (nodes_.empty()) return;
    int stack[64];
    int depth = 0;
    stack[depth++] = 0;
    while (depth > 0) {
      const Node& node = nodes_[stack[--depth]];
      if (!accept(node.box)) continue;
      if (node.count == 0) {
        stack[depth++] = node.first + 1;
        stack[depth++] = node.first;
        continue;
      }
      for (int i = node.first; i < node.first + node.count; ++i) {
        if (accept(boxes_[i])) visit(items_[i]);
      }
    }
  }

 private:
  struct Node {
    Box box;
    int first;  // its first face, or the first of two child nodes
    int count;  // faces; 0: two child nodes
  };

  void split(int node, int begin, int end);

  std::vector<Node> nodes_;
  std::vector<int> items_;
  std::vector<Box> boxes_;  // in the order of items_
};

/// Accepts boxes that a triangle may meet: by its own box, its plane and the planes through its edges, with a margin
/// for rounding.
class TriangleTest {
 public:
  TriangleTest(const Vec3& a, const Vec3& b, const Vec3& c);

  bool operator()(const Box& box) const {
    if (!box_.intersects(box)) return false;
    const Vec3 centre = 0.5 * (box.min() + box.max()) - origin_, half = 0.5 * (box.max() - box.min());
    const double margin = margin_ + turn_ * half.sum();
    if (std::abs(normal_.dot(centre)) > normal_.cwiseAbs().dot(half) + margin) return false;
    for (int k = 0; k < 3; ++k) {
      if (outward_[k].dot(centre) - height_[k] > outward_[k].cwiseAbs().dot(half) + margin) return false;
    }
    return true;
  }

 private:
  Box box_;
  Vec3 origin_, normal_;
  Vec3 outward_[3];
  double height_[3];
  double margin_, turn_;  // what rounding may do to lengths, and to directions [rad]
};

}  // namespace sunder::geometry::detail
