#include "crack/detail/nearest.h"

#include <cmath>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

namespace sunder::crack::detail {

namespace {

/// One line of positions along an axis: the nearest sources known so far compete for every position of the line.
class Line {
 public:
  explicit Line(int length) : site_(length), start_(length) {}

  /// The positions from `first` on, `stride` apart.
  void compete(int first, int stride, Nearest& nearest) {
    const int length = static_cast<int>(start_.size());
    const auto position = [&](int at) { return static_cast<std::size_t>(first + at * stride); };
    count_ = 0;
    for (int at = 0; at < length; ++at)
      if (const int source = nearest.source[position(at)]; source >= 0) add(at, nearest.squared[position(at)], source);
    for (int at = 0, best = 0; at < length && count_ > 0; ++at) {
      while (best + 1 < count_ && start_[best + 1] < at) ++best;
      const Site& site = site_[best];
      nearest.source[position(at)] = site.source;
      nearest.squared[position(at)] = site.height + (at - site.at) * (at - site.at);
    }
  }

 private:
  struct Site {
    int at, source, height;
  };

  /// A source that is `height` (squared) away from the line's position `at`; positions come in ascending order.
  void add(int at, int height, int source) {
    double from = -std::numeric_limits<double>::infinity();
    while (count_ > 0) {
      from = meeting(count_ - 1, at, height);
      if (from > start_[count_ - 1]) break;
      --count_;
    }
    if (count_ == 0) from = -std::numeric_limits<double>::infinity();
    site_[count_] = {at, source, height};
    start_[count_++] = from;
  }

  double meeting(int index, int at, int height) const {
    const Site& other = site_[index];
    return (static_cast<double>(height - other.height) / (at - other.at) + at + other.at) / 2;
  }

  std::vector<Site> site_;
  std::vector<double> start_;
  int count_ = 0;
};

}  // namespace

int squared_steps(const Lattice& lattice, int position_a, int position_b) {
  const auto a = lattice.coordinates(position_a), b = lattice.coordinates(position_b);
  int sum = 0;
  for (int axis = 0; axis < 3; ++axis) sum += (a[axis] - b[axis]) * (a[axis] - b[axis]);
  return sum;
}

Nearest nearest_marked(const Lattice& lattice, const std::vector<char>& marked) {
  Nearest result{std::vector<int>(marked.size(), -1), std::vector<int>(marked.size(), 0)};
  for (std::size_t position = 0; position < marked.size(); ++position)
    if (marked[position]) result.source[position] = static_cast<int>(position);
  const auto& size = lattice.size();
  for (int axis = 0; axis < 3; ++axis) {
    const int u = axis == 0 ? 1 : 0, v = axis == 2 ? 1 : 2;
    tbb::parallel_for(tbb::blocked_range<int>(0, size[v]), [&](const tbb::blocked_range<int>& layers) {
      Line line(size[axis]);
      for (int j = layers.begin(); j != layers.end(); ++j)
        for (int i = 0; i < size[u]; ++i)
          line.compete(i * lattice.stride(u) + j * lattice.stride(v), lattice.stride(axis), result);
    });
  }
  return result;
}

std::vector<char> dilated(const Lattice& lattice, const std::vector<char>& marked_nodes, double radius) {
  // Only nodes with an unmarked neighbour can reach anything new; reaching beyond the lattice's border is cut off.
  const int reach = static_cast<int>(std::floor(radius));
  std::vector<std::array<int, 3>> ball;
  for (int k = -reach; k <= reach; ++k)
    for (int j = -reach; j <= reach; ++j)
      for (int i = -reach; i <= reach; ++i)
        if (i * i + j * j + k * k <= radius * radius) ball.push_back({i, j, k});
  std::vector<char> result = marked_nodes;
  for (int node = 0; node < lattice.count(); ++node) {
    if (!marked_nodes[static_cast<std::size_t>(node)]) continue;
    bool rim = false;
    lattice.for_each_link(node, [&](int other) { rim = rim || !marked_nodes[static_cast<std::size_t>(other)]; });
    if (!rim) continue;
    for (const auto& [i, j, k] : ball)
      if (const int other = lattice.node_beside(node, i, j, k); other >= 0) result[static_cast<std::size_t>(other)] = 1;
  }
  return result;
}

}  // namespace sunder::crack::detail
