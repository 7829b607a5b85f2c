#pragma once
/// The time of damage as a field, and its gradient: the direction in which a crack ran.
#include <memory>
#include <optional>
#include <vector>

#include "core/types.h"

namespace sunder::crack {
namespace detail {
class IndexTable;
}

class TimeField {
 public:
  /// Points with a negative time are left out. `spacing` [m] is the spacing of the grid.
  /// A node's time is the weighted mean of the times of the points around it (Fan 2024, eq. 3.13), and so is the
  /// position that it stands for: with the node's own position, a node that has points on one side only is wrong.
  TimeField(const std::vector<Vec3>& points, const std::vector<double>& times, double spacing);

  bool empty() const { return nodes_.empty(); }

  struct Sample {
    double time = 0;               ///< [s]
    Vec3 gradient = Vec3::Zero();  ///< [s/m]
    Vec3 open = Vec3::Zero();      ///< unit direction in which the gradient is not known; zero: it is known
  };

  /// A linear fit to the nodes around `x`, weighted by their splines (in place of Fan 2024, eq. 3.14, to which it
  /// reduces on full stencils): exact for linear fields whatever nodes have data. Nodes of a thin sheet of damage can
  /// span a plane only; then the gradient is the one within the plane. Nothing where the nodes span less, or at the rim
  /// of the data.
  std::optional<Sample> at(const Vec3& x) const;

 private:
  struct Node {
    double weight = 0, time = 0;
    Vec3 position = Vec3::Zero();
  };

  double spacing_;
  std::shared_ptr<const detail::IndexTable> index_;
  std::vector<Node> nodes_;
};

}  // namespace sunder::crack
