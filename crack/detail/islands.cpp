#include "crack/detail/islands.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <queue>
#include <tuple>

#include "crack/detail/bins.h"

namespace sunder::crack::detail {

namespace {

/// Distances as whole numbers of this many to a spacing: equal on paper means equal here, also after the body was
/// turned or moved.
constexpr double distance_steps = 1 << 20;

std::vector<int> component_of(const LinkGraph& links, const std::vector<char>& member, int first,
                              std::vector<char>& seen) {
  std::vector<int> component = {first};
  seen[first] = 1;
  for (std::size_t next = 0; next < component.size(); ++next)
    for (int e = links.start[component[next]]; e < links.start[component[next] + 1]; ++e) {
      const int neighbour = links.neighbour[e];
      if (!member[neighbour] || seen[neighbour]) continue;
      seen[neighbour] = 1;
      component.push_back(neighbour);
    }
  return component;
}

void find_islands(const LinkGraph& links, const std::vector<char>& solid, int smallest, Partition& result) {
  const int n = static_cast<int>(solid.size());
  std::vector<char> seen(n, 0);
  for (int first = 0; first < n; ++first) {
    if (!solid[first] || seen[first]) continue;
    const std::vector<int> island = component_of(links, solid, first, seen);
    if (static_cast<int>(island.size()) < smallest) continue;
    for (int i : island) {
      result.piece[i] = result.count;
      result.is_island[i] = 1;
    }
    ++result.count;
  }
}

std::int64_t steps(double distance, double spacing) { return std::llround(distance / spacing * distance_steps); }

/// A piece that reached a point, and how far away its island is.
struct Arrival {
  int piece = -1;
  std::int64_t distance = 0;
};

constexpr int most_arrivals = 3;  // pieces that a point hears of: as many as meet along a line

using Arrivals = std::array<Arrival, most_arrivals>;  // nearest first

class Flood {
 public:
  Flood(const std::vector<Vec3>& points, const LinkGraph& links, double spacing, const Partition& islands)
      : points_(points), links_(links), spacing_(spacing), islands_(islands), arrivals_(points.size()) {}

  std::vector<Arrivals> run() {
    for (int i = 0; i < static_cast<int>(points_.size()); ++i)
      if (islands_.is_island[i]) offer_neighbours(i, i, 0);
    while (!queue_.empty()) {
      const auto [distance, source, point] = queue_.top();
      queue_.pop();
      if (settle(point, {islands_.piece[source], distance})) offer_neighbours(point, source, distance);
    }
    return std::move(arrivals_);
  }

 private:
  using Offer = std::tuple<std::int64_t, int, int>;  // distance, island point, point

  Arrival* free_slot(int point, int piece) {
    for (Arrival& arrival : arrivals_[point]) {
      if (arrival.piece == piece) return nullptr;
      if (arrival.piece < 0) return &arrival;
    }
    return nullptr;
  }

  bool settle(int point, Arrival arrival) {
    Arrival* const slot = free_slot(point, arrival.piece);
    if (slot) *slot = arrival;
    return slot != nullptr;
  }

  void offer_neighbours(int point, int source, std::int64_t distance) {
    for (int e = links_.start[point]; e < links_.start[point + 1]; ++e) {
      const int neighbour = links_.neighbour[e];
      if (islands_.is_island[neighbour] || !free_slot(neighbour, islands_.piece[source])) continue;
      const std::int64_t straight = steps((points_[neighbour] - points_[source]).norm(), spacing_);
      queue_.emplace(std::max(distance, straight), source, neighbour);
    }
  }

  const std::vector<Vec3>& points_;
  const LinkGraph& links_;
  double spacing_;
  const Partition& islands_;
  std::vector<Arrivals> arrivals_;
  std::priority_queue<Offer, std::vector<Offer>, std::greater<>> queue_;
};

/// The first piece to arrive, unless the one that is nearest in a straight line came by a way that is as good as
/// straight: handing on island points over a cloud is exact to less than a spacing only.
int choose_piece(const Arrivals& arrivals, int nearest_piece, std::int64_t nearest_distance) {
  constexpr std::int64_t slack = static_cast<std::int64_t>(0.5 * distance_steps);
  if (arrivals[0].piece < 0) return nearest_piece;
  const bool tied = arrivals[0].distance <= nearest_distance;
  if (tied) return arrivals[0].piece;
  for (const Arrival& arrival : arrivals)
    if (arrival.piece == nearest_piece && arrival.distance <= nearest_distance + slack) return nearest_piece;
  return arrivals[0].piece;
}

void flood(const std::vector<Vec3>& points, const LinkGraph& links, double spacing, Partition& result) {
  const std::vector<Arrivals> arrivals = Flood(points, links, spacing, result).run();
  std::vector<int> island_points;
  for (int i = 0; i < static_cast<int>(points.size()); ++i)
    if (result.is_island[i]) island_points.push_back(i);
  const PointBins islands(points, island_points, 2 * spacing);
  for (int i = 0; i < static_cast<int>(points.size()); ++i) {
    if (result.is_island[i]) continue;
    const PointBins::Nearest nearest = islands.nearest(points[i]);
    const int nearest_piece = result.piece[nearest.index];
    const std::int64_t distance = steps(nearest.distance, spacing);
    result.piece[i] = choose_piece(arrivals[i], nearest_piece, distance);
    const bool tied = arrivals[i][0].piece == result.piece[i] && arrivals[i][0].distance <= distance;
    result.is_astray[i] = result.piece[i] != nearest_piece && !tied;
  }
}

double effective_count(const Partition& partition) {
  std::vector<double> size(partition.count, 0.0);
  for (int piece : partition.piece) size[piece] += 1;
  double squares = 0;
  for (double s : size) squares += s * s;
  const double n = static_cast<double>(partition.piece.size());
  return n * n / squares;
}

}  // namespace

LinkGraph link_graph(const std::vector<Vec3>& points, double radius) {
  const PointBins bins(points, radius);
  LinkGraph graph;
  graph.start.reserve(points.size() + 1);
  graph.start.push_back(0);
  for (int i = 0; i < static_cast<int>(points.size()); ++i) {
    bins.for_each_within(points[i], radius, [&](int j, double) {
      if (j != i) graph.neighbour.push_back(j);
    });
    std::sort(graph.neighbour.begin() + graph.start.back(), graph.neighbour.end());
    graph.start.push_back(static_cast<int>(graph.neighbour.size()));
  }
  return graph;
}

Partition partition(const std::vector<Vec3>& points, const LinkGraph& links, const std::vector<char>& solid,
                    int smallest, double spacing) {
  Partition result;
  result.piece.assign(points.size(), 0);
  result.is_island.assign(points.size(), 0);
  result.is_astray.assign(points.size(), 0);
  find_islands(links, solid, smallest, result);
  if (result.count == 0) return result;
  flood(points, links, spacing, result);
  result.effective_count = effective_count(result);
  return result;
}

}  // namespace sunder::crack::detail
