#include "crack/detail/crossings.h"

namespace sunder::crack::detail {

namespace {

using geometry::Triangle;

double side(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& x) { return (b - a).cross(c - a).dot(x - a); }

/// Does the segment pq pass through the triangle? Touching is not passing.
bool pierces(const Vec3& p, const Vec3& q, const Vec3& a, const Vec3& b, const Vec3& c) {
  const double sp = side(a, b, c, p), sq = side(a, b, c, q);
  if (!(sp > 0 && sq < 0) && !(sp < 0 && sq > 0)) return false;
  const double u = side(p, q, a, b), v = side(p, q, b, c), w = side(p, q, c, a);
  return (u > 0 && v > 0 && w > 0) || (u < 0 && v < 0 && w < 0);
}

class Pairs {
 public:
  Pairs(const FineMesh& mesh, const std::vector<Vec3>& positions) : faces_(mesh.faces), x_(positions) {}

  bool cross(int f, int g) const {
    const Triangle &s = faces_[f], &t = faces_[g];
    int shared = 0, in_s = 0, in_t = 0;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j)
        if (s[i] == t[j]) ++shared, in_s = i, in_t = j;
    if (shared > 1 || separated(s, t, shared == 1 ? s[in_s] : -1)) return false;
    if (shared == 1) return edge_pierces(s, (in_s + 1) % 3, t) || edge_pierces(t, (in_t + 1) % 3, s);
    for (int i = 0; i < 3; ++i)
      if (edge_pierces(s, i, t) || edge_pierces(t, i, s)) return true;
    return false;
  }

 private:
  bool edge_pierces(const Triangle& s, int i, const Triangle& t) const {
    return pierces(x_[s[i]], x_[s[(i + 1) % 3]], x_[t[0]], x_[t[1]], x_[t[2]]);
  }

  /// Does one triangle lie on one side of the other's plane? Quick, and right for most pairs.
  bool separated(const Triangle& s, const Triangle& t, int shared) const {
    return on_one_side(s, t, shared) || on_one_side(t, s, shared);
  }

  bool on_one_side(const Triangle& s, const Triangle& t, int shared) const {
    const Vec3 n = (x_[s[1]] - x_[s[0]]).cross(x_[s[2]] - x_[s[0]]);
    int above = 0, below = 0;
    for (int v : t) {
      if (v == shared) continue;
      const double height = n.dot(x_[v] - x_[s[0]]);
      above += height >= 0;
      below += height <= 0;
    }
    const int others = shared < 0 ? 3 : 2;
    return above == others || below == others;
  }

  const std::vector<Triangle>& faces_;
  const std::vector<Vec3>& x_;
};

/// Boxes of triangles sorted into the cells that they touch.
struct Bins {
  std::vector<Box> boxes;  // per triangle; empty where it is left out
  std::vector<GridCell> cells;
  std::vector<int> start, faces;
  double width = 1;

  template <typename Visit>
  void for_each_cell(int f, Visit&& visit) {
    const GridCell low = cell_of(boxes[f].min(), width), high = cell_of(boxes[f].max(), width);
    for (int i = low.x(); i <= high.x(); ++i)
      for (int j = low.y(); j <= high.y(); ++j)
        for (int k = low.z(); k <= high.z(); ++k) visit(GridCell(i, j, k));
  }
};

/// Moved triangles, and what touches the box around them all.
std::vector<int> candidates(const FineMesh& mesh, const std::vector<char>& moved, Bins& bins) {
  Box all;
  double extent = 0;
  int count = 0;
  for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
    if (!moved[f]) continue;
    all.extend(bins.boxes[f]);
    extent += bins.boxes[f].sizes().maxCoeff();
    ++count;
  }
  bins.width = count > 0 ? 1.5 * extent / count : 1;
  if (count > 0) bins.width = std::max(bins.width, all.diagonal().norm() / largest_cell);
  std::vector<int> result;
  for (int f = 0; f < static_cast<int>(mesh.faces.size()); ++f) {
    if (count > 0) bins.boxes[f] = bins.boxes[f].intersection(all);
    if (count > 0 && !bins.boxes[f].isEmpty()) result.push_back(f);
  }
  return result;
}

Bins sorted_bins(const FineMesh& mesh, const std::vector<Vec3>& positions, const std::vector<char>& moved) {
  Bins bins;
  bins.boxes.resize(mesh.faces.size());
  for (std::size_t f = 0; f < mesh.faces.size(); ++f)
    for (int v : mesh.faces[f]) bins.boxes[f].extend(positions[v]);
  const std::vector<int> chosen = candidates(mesh, moved, bins);
  IndexTable table(chosen.size());
  std::vector<std::pair<int, int>> entries;  // cell, triangle
  entries.reserve(4 * chosen.size());
  for (int f : chosen)
    bins.for_each_cell(f, [&](const GridCell& cell) {
      const int c = table.insert(cell_key(cell));
      if (c == static_cast<int>(bins.cells.size())) bins.cells.push_back(cell);
      entries.emplace_back(c, f);
    });
  bins.start.assign(bins.cells.size() + 1, 0);
  for (const auto& [c, f] : entries) ++bins.start[c + 1];
  for (std::size_t c = 0; c < bins.cells.size(); ++c) bins.start[c + 1] += bins.start[c];
  bins.faces.resize(entries.size());
  std::vector<int> at(bins.start.begin(), bins.start.end() - 1);
  for (const auto& [c, f] : entries) bins.faces[at[c]++] = f;
  return bins;
}

}  // namespace

std::vector<std::pair<int, int>> crossings(const FineMesh& mesh, const std::vector<Vec3>& positions,
                                           const std::vector<char>& moved) {
  const Bins bins = sorted_bins(mesh, positions, moved);
  const Pairs pairs(mesh, positions);
  std::vector<std::pair<int, int>> result;
  for (std::size_t c = 0; c < bins.cells.size(); ++c)
    for (int i = bins.start[c]; i < bins.start[c + 1]; ++i)
      for (int j = i + 1; j < bins.start[c + 1]; ++j) {
        const int f = bins.faces[i], g = bins.faces[j];
        if (!moved[f] && !moved[g]) continue;
        const Vec3 low = bins.boxes[f].min().cwiseMax(bins.boxes[g].min());
        const Vec3 high = bins.boxes[f].max().cwiseMin(bins.boxes[g].max());
        if ((low.array() > high.array()).any()) continue;
        if (cell_of(low, bins.width) != bins.cells[c]) continue;  // another cell has this pair
        if (pairs.cross(f, g)) result.emplace_back(std::min(f, g), std::max(f, g));
      }
  std::sort(result.begin(), result.end());
  return result;
}

}  // namespace sunder::crack::detail
