#include "mpm/grid.h"

#include <cmath>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

namespace sunder::mpm {

Grid::Grid(const Box& domain, double cell_size, int margin, const Vec3& anchor)
    : cell_size_(cell_size), inverse_cell_size_(1 / cell_size) {
  std::size_t count = 1;
  for (int a = 0; a < 3; ++a) {
    const double low = std::floor((domain.min()[a] - anchor[a]) / cell_size) - margin;
    const double high = std::ceil((domain.max()[a] - anchor[a]) / cell_size) + margin;
    origin_[a] = anchor[a] + low * cell_size;
    size_[static_cast<std::size_t>(a)] = static_cast<int>(high - low) + 1;
    count *= static_cast<std::size_t>(size(a));
  }
  nodes_.assign(count, Node::Zero());
}

bool Grid::holds(const std::array<int, 3>& base) const {
  for (std::size_t a = 0; a < 3; ++a)
    if (base[a] < 0 || base[a] + 2 >= size_[a]) return false;
  return true;
}

void Grid::clear() { std::fill(nodes_.begin(), nodes_.end(), Node::Zero()); }

void Grid::momentum_to_velocity() {
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, nodes_.size(), 4096), [&](const auto& range) {
    for (std::size_t n = range.begin(); n < range.end(); ++n) {
      Node& node = nodes_[n];
      const double mass = node[3];
      // Weights go to zero smoothly, so a node can hold a mass whose inverse is not finite.
      if (mass > std::numeric_limits<double>::min() * 1e16)
        node.head<3>() /= mass;
      else
        node.setZero();
    }
  });
}

}  // namespace sunder::mpm
