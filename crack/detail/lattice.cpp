#include "crack/detail/lattice.h"

#include <cmath>
#include <string>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

namespace sunder::crack::detail {

namespace {

constexpr double most_positions = 400e6;  // 5 GB with everything that hangs on a position
constexpr double body_share = 0.2;        // of the weight deep inside: a flat surface a third of a spacing away has it

std::array<int, 18> steps_to_links(const Lattice& lattice) {
  std::array<int, 18> links{};
  std::size_t axial = 0, diagonal = 6;
  for (int k = -1; k <= 1; ++k)
    for (int j = -1; j <= 1; ++j)
      for (int i = -1; i <= 1; ++i) {
        const int far = i * i + j * j + k * k;
        if (far == 1) links[axial++] = lattice.step(i, j, k);
        if (far == 2) links[diagonal++] = lattice.step(i, j, k);
      }
  return links;
}

}  // namespace

Lattice::Lattice(const Box& box, double spacing, int border) : spacing_(spacing) {
  double count = 1;
  for (int axis = 0; axis < 3; ++axis) {
    const double half = std::ceil(box.sizes()[axis] / 2 / spacing) + border;
    count *= 2 * half + 1;
    if (!(count <= most_positions))
      throw Error(ErrorKind::usage, "crack: a node spacing of " + std::to_string(spacing) +
                                        " m is too fine for a body of " + std::to_string(box.sizes().maxCoeff()) +
                                        " m; make it coarser");
    middle_[axis] = static_cast<int>(half);
    size_[axis] = 2 * middle_[axis] + 1;
  }
  for (int axis = 0; axis < 3; ++axis) origin_[axis] = box.center()[axis] - middle_[axis] * spacing;
  links_ = steps_to_links(*this);
}

void Lattice::set_nodes(const std::vector<char>& marked) {
  node_at_.assign(marked.size(), -1);
  position_.clear();
  for (int position = 0; position < positions(); ++position) {
    if (!marked[static_cast<std::size_t>(position)]) continue;
    node_at_[static_cast<std::size_t>(position)] = count();
    position_.push_back(position);
  }
}

std::array<int, 3> Lattice::coordinates(int position) const {
  const int row = position / size_[0];
  return {position % size_[0] - middle_[0], row % size_[1] - middle_[1], row / size_[1] - middle_[2]};
}

Vec3 Lattice::at(int position) const {
  const auto [i, j, k] = coordinates(position);
  return origin_ + spacing_ * Vec3(i + middle_[0], j + middle_[1], k + middle_[2]);
}

int Lattice::node_beside(int node, int i, int j, int k) const {
  const std::array<int, 3> at = coordinates(position(node)), by = {i, j, k};
  for (int axis = 0; axis < 3; ++axis)
    if (std::abs(at[axis] + by[axis]) > middle_[axis]) return -1;
  return node_at(position(node) + step(i, j, k));
}

int Lattice::nearest(const Vec3& x) const {
  const auto [corner, rest] = cell_of(x);
  return corner + step(rest.x() >= 0.5, rest.y() >= 0.5, rest.z() >= 0.5);
}

namespace {

/// Sums of weights over points, per position.
struct Sums {
  explicit Sums(int positions) : weight(static_cast<std::size_t>(positions), 0.0), damage(weight) {}
  std::vector<double> weight, damage, timed, time;  // the last two: empty unless there are times
};

/// What the points give to the positions from `first` to `last`.
void add_points(const Lattice& lattice, const DamageField& field, double crack_damage, int first, int last,
                Sums& result) {
  const int cell_span = lattice.step(1, 1, 1);
  for (std::size_t p = 0; p < field.points.size(); ++p) {
    const auto [corner, rest] = lattice.cell_of(field.points[p]);
    if (corner + cell_span < first || corner >= last) continue;
    const double crack = field.damage[p] >= crack_damage;
    const bool timed = !field.damage_time.empty() && field.damage_time[p] >= 0;
    lattice.for_each_corner(corner, rest, [&](int position, double w) {
      if (position < first || position >= last) return;
      const std::size_t at = static_cast<std::size_t>(position);
      result.weight[at] += w;
      result.damage[at] += w * crack;
      if (!timed) return;
      result.timed[at] += w;
      result.time[at] += w * field.damage_time[p];
    });
  }
}

/// Every thread reads all points and has positions of its own, which get their points in order, however many threads
/// there are.
Sums sums(const Lattice& lattice, const DamageField& field, double crack_damage) {
  Sums result(lattice.positions());
  if (!field.damage_time.empty()) {
    result.timed.assign(result.weight.size(), 0.0);
    result.time = result.timed;
  }
  const int shares = tbb::this_task_arena::max_concurrency();
  const auto first = [&](int share) {
    return static_cast<int>(static_cast<long>(lattice.positions()) * share / shares);
  };
  tbb::parallel_for(
      0, shares, [&](int share) { add_points(lattice, field, crack_damage, first(share), first(share + 1), result); });
  return result;
}

std::vector<int> nearest_positions(const Lattice& lattice, const std::vector<Vec3>& points) {
  std::vector<int> nearest(points.size());
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, points.size()), [&](const auto& range) {
    for (std::size_t p = range.begin(); p != range.end(); ++p) nearest[p] = lattice.nearest(points[p]);
  });
  return nearest;
}

/// Where displaced points leave a gap, a node between others of the body is one of them.
void fill_holes(const Lattice& lattice, const std::vector<double>& weight, std::vector<char>& in_body) {
  const std::vector<char> before = in_body;
  for (int position = 0; position < lattice.positions(); ++position) {
    const std::size_t at = static_cast<std::size_t>(position);
    if (before[at] || !(weight[at] > 0)) continue;
    int beside = 0;
    for (int axis = 0; axis < 3; ++axis)
      for (const int step : {-lattice.stride(axis), lattice.stride(axis)})
        beside += before[static_cast<std::size_t>(position + step)];
    in_body[at] = beside >= 5;
  }
}

}  // namespace

Raster rasterise(const DamageField& field, const Box& domain, double spacing, double crack_damage) {
  Box box = domain;
  for (const Vec3& x : field.points) box.extend(x);
  Lattice lattice(box, spacing, 2);
  const Sums sum = sums(lattice, field, crack_damage);
  std::vector<char> in_body(sum.weight.size(), 0);
  const double least = body_share * std::pow(spacing / field.spacing, 3);
  for (std::size_t at = 0; at < in_body.size(); ++at) in_body[at] = sum.weight[at] > least;
  std::vector<int> nearest = nearest_positions(lattice, field.points);
  for (const int position : nearest) in_body[static_cast<std::size_t>(position)] = 1;
  fill_holes(lattice, sum.weight, in_body);
  lattice.set_nodes(in_body);
  for (int& position : nearest) position = lattice.node_at(position);

  Raster raster{std::move(lattice), {}, std::move(nearest), {}};
  raster.damage.resize(static_cast<std::size_t>(raster.lattice.count()));
  raster.damage_time.assign(raster.damage.size(), -1.0);
  for (std::size_t node = 0; node < raster.damage.size(); ++node) {
    const std::size_t at = static_cast<std::size_t>(raster.lattice.position(static_cast<int>(node)));
    raster.damage[node] = sum.damage[at] / sum.weight[at];
    if (!sum.timed.empty() && sum.timed[at] > 0) raster.damage_time[node] = sum.time[at] / sum.timed[at];
  }
  return raster;
}

}  // namespace sunder::crack::detail
