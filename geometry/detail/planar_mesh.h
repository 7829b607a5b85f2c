#pragma once
/// A triangulation of a triangle that grows point by point.
#include <array>
#include <cstdint>
#include <vector>

#include "geometry/detail/points.h"

namespace sunder::geometry::detail {

/// Whether the other diagonal (x, y) of the quad u, y, w, x makes better shaped triangles than (u, w).
bool worth_flipping(const Vec3& u, const Vec3& w, const Vec3& x, const Vec3& y);

/// The axis along which a triangle is seen largest. Errors: ErrorKind::mesh if it has no area.
int dominant_axis(const Points& points, const std::array<int, 3>& corners);

/// Vertices are numbered as they are added; the corners are 0, 1 and 2. Works in the plane seen along the dominant axis
/// of the triangle's normal, with exact signs; only the choice between valid diagonals is made in rounded numbers.
class PlanarMesh {
 public:
  struct Cell {
    std::array<int, 3> vertex;                  // counter-clockwise
    std::array<int, 3> across = {-1, -1, -1};   // the triangle beyond the side from vertex k to k + 1, -1: none
    std::array<int, 3> barrier = {-1, -1, -1};  // number of the barrier on that side, -1: none
  };

  PlanarMesh(const Points& points, const std::array<int, 3>& corners);

  /// Inserts points of the edge from corner k to the next, in this order.
  void add_on_edge(int k, const std::vector<int>& ids);

  /// Inserts a point inside and returns its vertex.
  int add_inside(int id);

  /// Makes the segment between two vertices a side of triangles that stays. Errors: see divide.
  void add_barrier(int from, int to, int number);

  const std::vector<Cell>& cells() const { return cells_; }
  int id(int vertex) const { return ids_[vertex]; }

  /// The edge of the triangle that both vertices lie on; -1 if none.
  int common_edge(int a, int b) const;

 private:
  struct Side {
    int cell, k;
  };

  int orientation(int a, int b, int c) const;
  int add_vertex(int id, std::uint8_t edges);
  Side locate(int vertex);
  void split_cell(int cell, int vertex);
  void split_side(Side side, int vertex);
  Side beyond(Side side) const;
  bool can_flip(Side side) const;
  void flip(Side side);
  bool wants_flip(Side side) const;
  void restore(std::vector<Side>& open);
  Side side_between(int from, int to) const;
  Side first_crossed(int from, int to) const;
  std::vector<std::array<int, 2>> crossed_sides(int from, int to) const;
  void clear_way(int from, int to);

  const Points& points_;
  int axis_ = 0, turn_ = 1;
  std::vector<int> ids_;
  std::vector<std::uint8_t> edges_;  // per vertex a bit for each edge of the triangle that it lies on
  std::vector<int> at_;              // per vertex a triangle around it
  std::vector<Cell> cells_;
  int last_ = 0;
  std::uint32_t dice_ = 1;
};

}  // namespace sunder::geometry::detail
