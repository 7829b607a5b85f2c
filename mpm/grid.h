#pragma once
/// The background grid: momentum (later velocity) and mass at the nodes of a box.
#include <array>
#include <vector>

#include "core/types.h"

namespace sunder::mpm {

/// Momentum or velocity in the first three entries, mass in the last.
using Node = Eigen::Vector4d;

class Grid {
 public:
  /// Covers `domain` with `margin` cells to spare on all sides. Node (0,0,0) lies on the lattice `anchor + cell_size *
  /// integers`.
  Grid(const Box& domain, double cell_size, int margin, const Vec3& anchor);

  double cell_size() const { return cell_size_; }
  const Vec3& origin() const { return origin_; }
  int size(int axis) const { return size_[static_cast<std::size_t>(axis)]; }
  /// World position in cells from node (0,0,0).
  Vec3 to_cells(const Vec3& x) const { return (x - origin_) * inverse_cell_size_; }
  /// True when the whole stencil of a particle with this lowest node is inside.
  bool holds(const std::array<int, 3>& base) const;

  std::size_t index(int i, int j, int k) const {
    return (static_cast<std::size_t>(i) * static_cast<std::size_t>(size_[1]) + static_cast<std::size_t>(j)) *
               static_cast<std::size_t>(size_[2]) +
           static_cast<std::size_t>(k);
  }
  Node& node(std::size_t at) { return nodes_[at]; }
  const Node& node(std::size_t at) const { return nodes_[at]; }
  const std::vector<Node>& nodes() const { return nodes_; }

  void clear();
  /// Divides momentum by mass; nodes without mass get zero velocity.
  void momentum_to_velocity();

 private:
  double cell_size_, inverse_cell_size_;
  Vec3 origin_;
  std::array<int, 3> size_;
  std::vector<Node> nodes_;
};

}  // namespace sunder::mpm
