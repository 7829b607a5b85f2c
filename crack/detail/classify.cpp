#include "crack/detail/classify.h"

#include <cmath>

#include "crack/detail/nearest.h"

namespace sunder::crack::detail {

namespace {

double damage_at(const Raster& raster, const Vec3& x) {
  double sum = 0, weights = 0;
  for_each_node_around(raster.lattice, x, [&](std::size_t node, double w) {
    sum += w * raster.damage[node];
    weights += w;
  });
  return weights > 0.5 ? sum / weights : 0;
}

}  // namespace

bool damage_between(const Raster& raster, const Vec3& a, const Vec3& b, double crack_damage) {
  const double length = (b - a).norm(), spacing = raster.lattice.spacing();
  const double inside = std::max(0.0, length - spacing);
  const int steps = static_cast<int>(std::ceil(2 * inside / spacing));
  for (int step = 0; step <= steps; ++step) {
    const double along = (length - inside) / 2 + (steps > 0 ? inside * step / steps : 0.0);
    if (damage_at(raster, a + along / length * (b - a)) < crack_damage) return false;
  }
  return true;
}

double damage_time_at(const Raster& raster, const Vec3& x) {
  double sum = 0, weights = 0;
  for_each_node_around(raster.lattice, x, [&](std::size_t node, double w) {
    if (raster.damage_time[node] < 0) return;
    sum += w * raster.damage_time[node];
    weights += w;
  });
  return weights > 0 ? sum / weights : -1;
}

bool on_one_side(const Raster& raster, int node_a, int node_b, double crack_damage) {
  const Lattice& lattice = raster.lattice;
  const auto sound_links = [&](int node) {
    std::vector<int> positions = {lattice.position(node)};
    lattice.for_each_link(node, [&](int other) {
      if (raster.damage[static_cast<std::size_t>(other)] < crack_damage) positions.push_back(lattice.position(other));
    });
    return positions;
  };
  const std::vector<int> a = sound_links(node_a), b = sound_links(node_b);
  for (const int u : a)
    for (const int v : b)
      if (squared_steps(lattice, u, v) <= 2) return true;
  return false;
}

}  // namespace sunder::crack::detail
