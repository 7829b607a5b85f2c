#pragma once
/// A background grid that the vertices of one sheet share, so that no other sheet shines through.
#include <vector>

#include "crack/detail/spline_stencil.h"

namespace sunder::crack::detail {

class SheetGrid {
 public:
  /// Keeps a reference to `positions`. `vertices`: those of the sheet.
  SheetGrid(const std::vector<Vec3>& positions, const std::vector<int>& vertices, double spacing)
      : positions_(positions), vertices_(vertices), spacing_(spacing), table_(vertices.size() / 2) {
    ids_.reserve(27 * vertices.size());
    for (int v : vertices)
      SplineStencil(positions[v], spacing).for_each([&](std::uint64_t key, double) {
        ids_.push_back(table_.insert(key));
      });
  }

  int node_count() const { return table_.size(); }

  /// Adds w * value to the nodes around `x`; nodes that no vertex of the sheet uses get nothing.
  template <typename Value>
  void deposit(const Vec3& x, const Value& value, std::vector<Value>& nodes) const {
    SplineStencil(x, spacing_).for_each([&](std::uint64_t key, double w) {
      const int n = table_.find(key);
      if (n >= 0) nodes[n] += w * value;
    });
  }

  /// The same for a vertex: number `i` of the sheet's.
  template <typename Value>
  void deposit_vertex(std::size_t i, const Value& value, std::vector<Value>& nodes) const {
    const int* id = &ids_[27 * i];
    SplineStencil(positions_[vertices_[i]], spacing_).for_each([&](std::uint64_t, double w) {
      nodes[*id++] += w * value;
    });
  }

  /// Sum of w * node value at vertex number `i` of the sheet's.
  template <typename Value>
  Value gather(std::size_t i, const std::vector<Value>& nodes, Value sum) const {
    const int* id = &ids_[27 * i];
    SplineStencil(positions_[vertices_[i]], spacing_).for_each([&](std::uint64_t, double w) {
      sum += w * nodes[*id++];
    });
    return sum;
  }

 private:
  const std::vector<Vec3>& positions_;
  const std::vector<int>& vertices_;
  double spacing_;
  IndexTable table_;
  std::vector<int> ids_;  // 27 per vertex
};

}  // namespace sunder::crack::detail
