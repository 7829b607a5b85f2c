#pragma once
/// Damage of a cloud of points on a lattice of its own: which nodes lie in the body, and how damaged they are.
#include <array>
#include <vector>

#include "core/types.h"
#include "crack/extract.h"

namespace sunder::crack::detail {

/// The nodes of a cubic lattice that lie in a body. Nodes are numbered in the order of their positions; a border of
/// empty positions lies around all of them, so that a step from a node to a neighbour never leaves the lattice.
class Lattice {
 public:
  /// Covers `box` with room for `border` more positions on every side; the middle of the box is a position.
  /// Errors: ErrorKind::usage when that takes more positions than fit in memory.
  Lattice(const Box& box, double spacing, int border);

  /// Makes nodes of the positions that are marked.
  void set_nodes(const std::vector<char>& marked);

  double spacing() const { return spacing_; }
  const std::array<int, 3>& size() const { return size_; }
  int positions() const { return size_[0] * size_[1] * size_[2]; }
  int count() const { return static_cast<int>(position_.size()); }

  int node_at(int position) const { return node_at_[static_cast<std::size_t>(position)]; }  ///< -1: not in the body
  int position(int node) const { return position_[static_cast<std::size_t>(node)]; }
  /// Relative to the middle of the box, in spacings.
  std::array<int, 3> coordinates(int position) const;
  /// How far a step along the axes moves a position.
  int step(int i, int j, int k) const { return (k * size_[1] + j) * size_[0] + i; }
  int stride(int axis) const { return step(axis == 0, axis == 1, axis == 2); }
  Vec3 at(int position) const;
  Vec3 point(int node) const { return at(position(node)); }

  /// The node so many steps away from another; -1: not in the body.
  int node_beside(int node, int i, int j, int k) const;

  /// The position at the lower corner of the lattice's cell that holds `x`, and where in that cell, each in [0, 1].
  std::pair<int, Vec3> cell_of(const Vec3& x) const {
    std::array<int, 3> cell;
    Vec3 rest;
    for (int axis = 0; axis < 3; ++axis) {
      const double local = (x[axis] - origin_[axis]) / spacing_;
      cell[axis] = std::clamp(static_cast<int>(local), 0, size_[axis] - 2);
      rest[axis] = std::clamp(local - cell[axis], 0.0, 1.0);
    }
    return {step(cell[0], cell[1], cell[2]), rest};
  }
  /// The position nearest to `x`.
  int nearest(const Vec3& x) const;
  /// Calls visit(position, weight) for the eight corners of that cell with their trilinear weights.
  template <typename Visit>
  void for_each_corner(const Vec3& x, Visit&& visit) const {
    const auto [corner, r] = cell_of(x);
    for_each_corner(corner, r, visit);
  }
  /// The same for the place `r` in the cell whose lower corner is known.
  template <typename Visit>
  void for_each_corner(int corner, const Vec3& r, Visit&& visit) const {
    for (int k = 0; k < 2; ++k)
      for (int j = 0; j < 2; ++j)
        for (int i = 0; i < 2; ++i)
          visit(corner + step(i, j, k), (i ? r.x() : 1 - r.x()) * (j ? r.y() : 1 - r.y()) * (k ? r.z() : 1 - r.z()));
  }

  /// Steps to the 6 neighbours along the axes, then to the 12 along diagonals of faces: links of up to 1.5 spacings.
  const std::array<int, 18>& links() const { return links_; }

  /// Calls visit(node) for the neighbours in the body that a link joins to a node.
  template <typename Visit>
  void for_each_link(int node, Visit&& visit) const {
    for (const int link : links_)
      if (const int other = node_at(position(node) + link); other >= 0) visit(other);
  }

 private:
  Vec3 origin_;  // of position 0
  double spacing_;
  std::array<int, 3> size_, middle_;
  std::array<int, 18> links_;
  std::vector<int> node_at_, position_;
};

/// A damage field on its lattice.
struct Raster {
  Lattice lattice;
  std::vector<double> damage;       ///< per node: weighted share of its points that are crack, in [0, 1]
  std::vector<int> nearest;         ///< per point of the field: the node nearest to it
  std::vector<double> damage_time;  ///< per node: weighted mean of its points that have one [s], -1: none has
};

/// Calls visit(node, weight) for the nodes of the body around `x` with their trilinear weights.
template <typename Visit>
void for_each_node_around(const Lattice& lattice, const Vec3& x, Visit&& visit) {
  lattice.for_each_corner(x, [&](int position, double w) {
    if (const int node = lattice.node_at(position); node >= 0) visit(static_cast<std::size_t>(node), w);
  });
}

/// Trilinear weights, normalised by their sum: Fan (2024), eq. 3.1, which leaves out the sum, so that a unit field
/// would become the number of points in a cell. A node is in the body when its weights are a fifth of what they are
/// deep inside, or when it is the nearest of a point.
Raster rasterise(const DamageField& field, const Box& domain, double spacing, double crack_damage);

}  // namespace sunder::crack::detail
