#include "geometry/detail/voxel_regions.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <unordered_map>

#include "geometry/detail/labels.h"
#include "geometry/detail/predicates.h"

namespace sunder::geometry::detail {
namespace {

/// The first and last crack faces on the line from a point to the next one along an axis.
struct Passage {
  double first_at, last_at;
  int behind, beyond;  // regions before the first and after the last
};

using Passages = std::unordered_map<std::int64_t, Passage>;  // by axis and lower point

std::int64_t key(int axis, int index) { return 3 * static_cast<std::int64_t>(index) + axis; }

// Lattice lines along the axis that pierce the triangle. A line through an edge counts for one of the two triangles of
// a sheet that turn the same way, as the edge's sign does not depend on the triangle.
void rasterize(const Lattice& lattice, const CrackComplex& complex, int triangle, int axis, Passages& passages) {
  const int u = (axis + 1) % 3, v = (axis + 2) % 3;
  std::array<Vec3, 3> p;
  Box box;
  for (int k = 0; k < 3; ++k) {
    p[k] = (complex.vertices[complex.triangles[triangle][k]] - lattice.origin) / lattice.spacing;
    box.extend(p[k]);
  }
  const Vec3 normal = (p[1] - p[0]).cross(p[2] - p[0]);
  const int turn = planar_orientation(p[0][u], p[0][v], p[1][u], p[1][v], p[2][u], p[2][v]);
  if (turn == 0 || normal[axis] == 0) return;
  const auto clamped = [&](double x, int k) { return static_cast<int>(std::clamp(x, -1.0, 1.0 * lattice.count[k])); };
  const CrackComplex::Owner& owner = complex.owner[triangle];
  for (int j = std::max(0, clamped(std::ceil(box.min()[u]), u)); j < lattice.count[u] && j <= box.max()[u]; ++j) {
    for (int k = std::max(0, clamped(std::ceil(box.min()[v]), v)); k < lattice.count[v] && k <= box.max()[v]; ++k) {
      const auto inside = [&](const Vec3& a, const Vec3& b) {
        const int side = planar_orientation(a[u], a[v], b[u], b[v], j, k);
        return side == turn || (side == 0 && turn > 0);
      };
      if (!inside(p[0], p[1]) || !inside(p[1], p[2]) || !inside(p[2], p[0])) continue;
      const double at = p[0][axis] - (normal[u] * (j - p[0][u]) + normal[v] * (k - p[0][v])) / normal[axis];
      const double cell = std::floor(at);
      if (cell < 0 || cell >= lattice.count[axis] - 1) continue;
      std::array<int, 3> point{};
      point[axis] = static_cast<int>(cell), point[u] = j, point[v] = k;
      // The normal points from inside to outside.
      const int behind = turn > 0 ? owner.inside : owner.outside, beyond = turn > 0 ? owner.outside : owner.inside;
      const auto [found, added] =
          passages.emplace(key(axis, lattice.index(point[0], point[1], point[2])), Passage{at, at, behind, beyond});
      if (!added && at < found->second.first_at) found->second.first_at = at, found->second.behind = behind;
      if (!added && at > found->second.last_at) found->second.last_at = at, found->second.beyond = beyond;
    }
  }
}

}  // namespace

std::vector<int> voxel_regions(const Lattice& lattice, const std::vector<char>& wanted, const CrackComplex& complex) {
  Passages passages;
  for (int triangle = 0; triangle < static_cast<int>(complex.triangles.size()); ++triangle) {
    for (int axis = 0; axis < 3; ++axis) rasterize(lattice, complex, triangle, axis, passages);
  }
  const std::array<int, 3> step = {1, lattice.count[0], lattice.count[0] * lattice.count[1]};
  std::vector<int> region(lattice.size(), -1), open;
  for (int start = 0; start < lattice.size(); ++start) {
    if (!wanted[start] || region[start] >= 0) continue;
    region[start] = region_at(lattice.point(start), complex);
    open.push_back(start);
    for (std::size_t i = 0; i < open.size(); ++i) {
      const int here = open[i];
      for (int axis = 0; axis < 3; ++axis) {
        const int place = here / step[axis] % lattice.count[axis];
        for (const int direction : {-1, 1}) {
          if (place + direction < 0 || place + direction >= lattice.count[axis]) continue;
          const int there = here + direction * step[axis];
          if (!wanted[there] || region[there] >= 0) continue;
          const auto passage = passages.find(key(axis, std::min(here, there)));
          const bool free = passage == passages.end();
          region[there] = free ? region[here] : direction > 0 ? passage->second.beyond : passage->second.behind;
          open.push_back(there);
        }
      }
    }
    open.clear();
  }
  return region;
}

}  // namespace sunder::geometry::detail
