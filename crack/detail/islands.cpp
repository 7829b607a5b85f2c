#include "crack/detail/islands.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <queue>
#include <tuple>

#include "crack/detail/nearest.h"

namespace sunder::crack::detail {

namespace {

using Index = std::size_t;

std::vector<int> component_of(const Lattice& lattice, const std::vector<char>& member, int first,
                              std::vector<char>& seen) {
  std::vector<int> component = {first};
  seen[static_cast<Index>(first)] = 1;
  for (Index next = 0; next < component.size(); ++next)
    lattice.for_each_link(component[next], [&](int other) {
      const Index o = static_cast<Index>(other);
      if (!member[o] || seen[o]) return;
      seen[o] = 1;
      component.push_back(other);
    });
  return component;
}

void add_island(const std::vector<int>& nodes, Partition& result) {
  for (const int node : nodes) {
    result.piece[static_cast<Index>(node)] = result.count;
    result.is_island[static_cast<Index>(node)] = 1;
  }
  ++result.count;
}

/// A piece that reached a node, and the squared distance that it came from.
struct Arrival {
  int piece = -1;
  int squared = 0;
};

constexpr int most_arrivals = 3;  // pieces that a node hears of: as many as meet along a line

using Arrivals = std::array<Arrival, most_arrivals>;  // nearest first

class Flood {
 public:
  Flood(const Lattice& lattice, const Partition& islands, const std::vector<int>& open)
      : lattice_(lattice), islands_(islands), place_(static_cast<Index>(lattice.count()), -1), arrivals_(open.size()) {
    for (Index i = 0; i < open.size(); ++i) place_[static_cast<Index>(open[i])] = static_cast<int>(i);
    for (const int node : open)
      lattice.for_each_link(node, [&](int other) {
        if (place_[static_cast<Index>(other)] < 0) offer(node, other, 0);
      });
  }

  /// Per open node.
  std::vector<Arrivals> run() {
    while (!queue_.empty()) {
      const auto [squared, source, node] = queue_.top();
      queue_.pop();
      Arrival* const slot = free_slot(node, piece_of(source));
      if (!slot) continue;
      *slot = {piece_of(source), squared};
      offer_neighbours(node, source, squared);
    }
    return std::move(arrivals_);
  }

 private:
  using Offer = std::tuple<int, int, int>;  // squared distance, island node, node

  int piece_of(int node) const { return islands_.piece[static_cast<Index>(node)]; }

  Arrival* free_slot(int node, int piece) {
    for (Arrival& arrival : arrivals_[static_cast<Index>(place_[static_cast<Index>(node)])]) {
      if (arrival.piece == piece) return nullptr;
      if (arrival.piece < 0) return &arrival;
    }
    return nullptr;
  }

  void offer(int node, int source, int squared) {
    const int straight = squared_steps(lattice_, lattice_.position(node), lattice_.position(source));
    queue_.emplace(std::max(squared, straight), source, node);
  }

  void offer_neighbours(int node, int source, int squared) {
    lattice_.for_each_link(node, [&](int other) {
      if (place_[static_cast<Index>(other)] >= 0 && free_slot(other, piece_of(source))) offer(other, source, squared);
    });
  }

  const Lattice& lattice_;
  const Partition& islands_;
  std::vector<int> place_;  // per node: which of the open ones it is, -1: on an island
  std::vector<Arrivals> arrivals_;
  std::priority_queue<Offer, std::vector<Offer>, std::greater<>> queue_;
};

/// The first piece to arrive, unless the one that is nearest in a straight line came by a way that is as good as
/// straight: handing on island nodes from neighbour to neighbour is exact to less than a spacing only.
Arrival choose(const Arrivals& arrivals, const Arrival& nearest) {
  constexpr double slack = 0.5;
  if (arrivals[0].piece < 0) return nearest;
  if (arrivals[0].squared <= nearest.squared) return arrivals[0];
  const double close = std::sqrt(nearest.squared) + slack;
  for (const Arrival& arrival : arrivals)
    if (arrival.piece == nearest.piece && arrival.squared <= close * close) return arrival;
  return arrivals[0];
}

void flood(const Lattice& lattice, Partition& result) {
  std::vector<int> open;
  std::vector<char> islands(static_cast<Index>(lattice.positions()), 0);
  for (int node = 0; node < lattice.count(); ++node) {
    const bool is_island = result.is_island[static_cast<Index>(node)];
    islands[static_cast<Index>(lattice.position(node))] = is_island;
    if (!is_island) open.push_back(node);
  }
  const std::vector<Arrivals> arrivals = Flood(lattice, result, open).run();
  const Nearest nearest = nearest_marked(lattice, islands);
  for (Index i = 0; i < open.size(); ++i) {
    const Index node = static_cast<Index>(open[i]), position = static_cast<Index>(lattice.position(open[i]));
    const Index source = static_cast<Index>(lattice.node_at(nearest.source[position]));
    const Arrival arrival = choose(arrivals[i], {result.piece[source], nearest.squared[position]});
    result.piece[node] = arrival.piece;
    result.reach[node] = arrival.squared;
  }
}

}  // namespace

Partition find_islands(const Lattice& lattice, const std::vector<char>& solid, const IslandRequest& request) {
  Partition result;
  result.piece.assign(solid.size(), 0);
  result.is_island.assign(solid.size(), 0);
  std::vector<char> seen(solid.size(), 0);
  for (int first = 0; first < lattice.count(); ++first) {
    if (!solid[static_cast<Index>(first)] || seen[static_cast<Index>(first)]) continue;
    const std::vector<int> island = component_of(lattice, solid, first, seen);
    if (static_cast<int>(island.size()) >= request.smallest) add_island(island, result);
  }
  for (const int seed : request.seeds)
    if (!result.is_island[static_cast<Index>(seed)]) add_island({seed}, result);
  return result;
}

void flood_from_islands(const Lattice& lattice, Partition& partition) {
  partition.reach.assign(partition.piece.size(), 0);
  if (partition.count > 0) flood(lattice, partition);
}

double effective_count(const Partition& partition) {
  std::vector<double> size(static_cast<Index>(std::max(partition.count, 1)), 0.0);
  double sum = 0, squares = 0;
  for (Index node = 0; node < partition.piece.size(); ++node)
    if (partition.is_island[node]) size[static_cast<Index>(partition.piece[node])] += 1;
  for (const double s : size) {
    sum += s;
    squares += s * s;
  }
  return squares > 0 ? sum * sum / squares : 1;
}

}  // namespace sunder::crack::detail
