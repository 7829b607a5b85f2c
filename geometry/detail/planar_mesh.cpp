#include "geometry/detail/planar_mesh.h"

#include <algorithm>
#include <cmath>
#include <deque>

#include "core/error.h"

namespace sunder::geometry::detail {
namespace {

[[noreturn]] void reject(const char* why) { throw Error(ErrorKind::mesh, why); }

constexpr int next(int k) { return (k + 1) % 3; }
constexpr int last(int k) { return (k + 2) % 3; }

int corner_of(const PlanarMesh::Cell& cell, int vertex) {
  return cell.vertex[0] == vertex ? 0 : cell.vertex[1] == vertex ? 1 : 2;
}

void repoint(std::vector<PlanarMesh::Cell>& cells, int cell, int from, int to) {
  if (cell < 0) return;
  for (int& across : cells[cell].across) {
    if (across == from) across = to;
  }
}

}  // namespace

bool worth_flipping(const Vec3& u, const Vec3& w, const Vec3& x, const Vec3& y) {
  // The angles at x and y add up to more than half a turn, by more than rounding.
  constexpr double kMargin = 1e-12;
  const Vec3 xu = u - x, xw = w - x, yu = u - y, yw = w - y;
  const double cos_x = xu.dot(xw), sin_x = xu.cross(xw).norm(), cos_y = yu.dot(yw), sin_y = yu.cross(yw).norm();
  return cos_x * sin_y + cos_y * sin_x < -kMargin * (std::abs(cos_x) + sin_x) * (std::abs(cos_y) + sin_y);
}

int dominant_axis(const Points& points, const std::array<int, 3>& corners) {
  const Vec3 &a = points[corners[0]], &b = points[corners[1]], &c = points[corners[2]];
  const Vec3 normal = (b - a).cross(c - a).cwiseAbs();
  std::array<int, 3> axes = {0, 1, 2};
  std::sort(axes.begin(), axes.end(), [&](int i, int j) { return normal[i] > normal[j]; });
  for (const int axis : axes) {
    if (points.orientation(axis, corners[0], corners[1], corners[2]) != 0) return axis;
  }
  reject("a triangle has no area");
}

PlanarMesh::PlanarMesh(const Points& points, const std::array<int, 3>& corners)
    : points_(points), axis_(dominant_axis(points, corners)) {
  // Bit k: edge k, from corner k to the next.
  add_vertex(corners[0], 0b101);
  add_vertex(corners[1], 0b011);
  add_vertex(corners[2], 0b110);
  turn_ = points.orientation(axis_, corners[0], corners[1], corners[2]);
  cells_.push_back({{0, 1, 2}});
  at_ = {0, 0, 0};
}

int PlanarMesh::add_vertex(int id, std::uint8_t edges) {
  ids_.push_back(id);
  edges_.push_back(edges);
  at_.push_back(-1);
  return static_cast<int>(ids_.size()) - 1;
}

int PlanarMesh::common_edge(int a, int b) const {
  const int common = edges_[a] & edges_[b];
  return common == 0 ? -1 : common == 1 ? 0 : common == 2 ? 1 : 2;
}

int PlanarMesh::orientation(int a, int b, int c) const {
  if ((edges_[a] & edges_[b] & edges_[c]) != 0) return 0;
  return turn_ * points_.orientation(axis_, ids_[a], ids_[b], ids_[c]);
}

// ---- Points ---------------------------------------------------------------------------------------------------

void PlanarMesh::add_on_edge(int k, const std::vector<int>& ids) {
  int from = k;
  for (const int id : ids) {
    const Side side = side_between(from, next(k));
    const int vertex = add_vertex(id, static_cast<std::uint8_t>(1 << k));
    split_side(side, vertex);
    from = vertex;
  }
}

int PlanarMesh::add_inside(int id) {
  const int vertex = add_vertex(id, 0);
  const Side side = locate(vertex);
  if (side.k >= 0) {
    if (cells_[side.cell].across[side.k] < 0) reject("a point lies on an edge that it should not meet");
    split_side(side, vertex);
  } else {
    split_cell(side.cell, vertex);
  }
  last_ = at_[vertex];
  return vertex;
}

// A walk across sides that part the cell from the vertex; starting with a random side keeps it from going in circles.
PlanarMesh::Side PlanarMesh::locate(int vertex) {
  int cell = last_, came_from = -1;
  for (;;) {
    dice_ = dice_ * 1664525u + 1013904223u;
    const int start = static_cast<int>((dice_ >> 16) % 3);
    int on = -1, crossed = -1;
    const Cell& here = cells_[cell];
    for (int i = 0; i < 3 && crossed < 0; ++i) {
      const int k = (start + i) % 3;
      if (here.across[k] >= 0 && here.across[k] == came_from) continue;
      const int turn = orientation(here.vertex[k], here.vertex[next(k)], vertex);
      if (turn < 0) crossed = k;
      if (turn == 0 && on >= 0) reject("two points coincide");
      if (turn == 0) on = k;
    }
    if (crossed < 0) return {cell, on};
    if (here.across[crossed] < 0) reject("a point lies outside its triangle");
    came_from = cell;
    cell = here.across[crossed];
  }
}

void PlanarMesh::split_cell(int cell, int p) {
  const Cell old = cells_[cell];
  const auto [a, b, c] = old.vertex;
  const int second = static_cast<int>(cells_.size()), third = second + 1;
  cells_[cell] = {{a, b, p}, {old.across[0], second, third}, {old.barrier[0], -1, -1}};
  cells_.push_back({{b, c, p}, {old.across[1], third, cell}, {old.barrier[1], -1, -1}});
  cells_.push_back({{c, a, p}, {old.across[2], cell, second}, {old.barrier[2], -1, -1}});
  repoint(cells_, old.across[1], cell, second);
  repoint(cells_, old.across[2], cell, third);
  at_[a] = at_[p] = cell, at_[b] = second, at_[c] = third;
  std::vector<Side> open = {{cell, 0}, {second, 0}, {third, 0}};
  restore(open);
}

void PlanarMesh::split_side(Side side, int p) {
  const int near = side.cell, k = side.k, half = static_cast<int>(cells_.size());
  const Cell old = cells_[near];
  const int u = old.vertex[k], w = old.vertex[next(k)], x = old.vertex[last(k)], far = old.across[k];
  const int far_half = far < 0 ? -1 : half + 1;
  cells_[near] = {{u, p, x}, {far, half, old.across[last(k)]}, {old.barrier[k], -1, old.barrier[last(k)]}};
  cells_.push_back({{p, w, x}, {far_half, old.across[next(k)], near}, {old.barrier[k], old.barrier[next(k)], -1}});
  repoint(cells_, old.across[next(k)], near, half);
  at_[u] = at_[p] = at_[x] = near, at_[w] = half;
  std::vector<Side> open = {{near, 2}, {half, 1}};
  if (far >= 0) {
    const Cell other = cells_[far];
    const int j = corner_of(other, w), y = other.vertex[last(j)];
    cells_[far] = {{p, u, y}, {near, other.across[next(j)], far_half}, {other.barrier[j], other.barrier[next(j)], -1}};
    cells_.push_back({{w, p, y}, {half, far, other.across[last(j)]}, {other.barrier[j], -1, other.barrier[last(j)]}});
    repoint(cells_, other.across[last(j)], far, far_half);
    at_[y] = far;
    open.insert(open.end(), {{far, 1}, {far_half, 2}});
  }
  restore(open);
}

// ---- Flips ----------------------------------------------------------------------------------------------------

PlanarMesh::Side PlanarMesh::beyond(Side side) const {
  const Cell& cell = cells_[side.cell];
  const int other = cell.across[side.k];
  return {other, corner_of(cells_[other], cell.vertex[next(side.k)])};
}

bool PlanarMesh::can_flip(Side side) const {
  const Side far = beyond(side);
  const Cell& cell = cells_[side.cell];
  const int u = cell.vertex[side.k], w = cell.vertex[next(side.k)], x = cell.vertex[last(side.k)];
  const int y = cells_[far.cell].vertex[last(far.k)];
  return orientation(u, y, x) > 0 && orientation(y, w, x) > 0;
}

bool PlanarMesh::wants_flip(Side side) const {
  const Cell& cell = cells_[side.cell];
  if (cell.across[side.k] < 0 || cell.barrier[side.k] >= 0) return false;
  const Side far = beyond(side);
  const auto at = [&](int vertex) -> const Vec3& { return points_[ids_[vertex]]; };
  return worth_flipping(at(cell.vertex[side.k]), at(cell.vertex[next(side.k)]), at(cell.vertex[last(side.k)]),
                        at(cells_[far.cell].vertex[last(far.k)]));
}

// Afterwards the new side is number 1 of the near cell and number 2 of the far one.
void PlanarMesh::flip(Side side) {
  const Side other = beyond(side);
  const int near = side.cell, far = other.cell, k = side.k, j = other.k;
  const Cell a = cells_[near], b = cells_[far];
  const int u = a.vertex[k], w = a.vertex[next(k)], x = a.vertex[last(k)], y = b.vertex[last(j)];
  cells_[near] = {{u, y, x}, {b.across[next(j)], far, a.across[last(k)]}, {b.barrier[next(j)], -1, a.barrier[last(k)]}};
  cells_[far] = {{y, w, x}, {b.across[last(j)], a.across[next(k)], near}, {b.barrier[last(j)], a.barrier[next(k)], -1}};
  repoint(cells_, b.across[next(j)], far, near);
  repoint(cells_, a.across[next(k)], near, far);
  at_[u] = at_[x] = at_[y] = near, at_[w] = far;
}

void PlanarMesh::restore(std::vector<Side>& open) {
  // Rounding could make the choices go in circles.
  int budget = 100 + 50 * static_cast<int>(ids_.size());
  while (!open.empty() && budget-- > 0) {
    const Side side = open.back();
    open.pop_back();
    if (!wants_flip(side) || !can_flip(side)) continue;
    const int far = beyond(side).cell;
    flip(side);
    open.insert(open.end(), {{side.cell, 0}, {side.cell, 2}, {far, 0}, {far, 1}});
  }
}

// ---- Barriers -------------------------------------------------------------------------------------------------

// Calls visit(cell, corner at the vertex) around a vertex until it returns true.
template <typename Visit>
static void around(const std::vector<PlanarMesh::Cell>& cells, int start, int vertex, const Visit& visit) {
  int cell = start;
  do {
    const int i = corner_of(cells[cell], vertex);
    if (visit(cell, i)) return;
    cell = cells[cell].across[last(i)];
  } while (cell >= 0 && cell != start);
  if (cell == start) return;
  for (cell = cells[start].across[corner_of(cells[start], vertex)]; cell >= 0;) {
    const int i = corner_of(cells[cell], vertex);
    if (visit(cell, i)) return;
    cell = cells[cell].across[i];
  }
}

PlanarMesh::Side PlanarMesh::side_between(int from, int to) const {
  Side found{-1, -1};
  around(cells_, at_[from], from, [&](int cell, int i) {
    if (cells_[cell].vertex[next(i)] == to) found = {cell, i};
    if (cells_[cell].vertex[last(i)] == to) found = {cell, last(i)};
    return found.cell >= 0;
  });
  return found;
}

PlanarMesh::Side PlanarMesh::first_crossed(int from, int to) const {
  Side found{-1, -1};
  around(cells_, at_[from], from, [&](int cell, int i) {
    const Cell& here = cells_[cell];
    if (orientation(from, here.vertex[next(i)], to) <= 0) return false;
    if (orientation(from, here.vertex[last(i)], to) >= 0) return false;
    found = {cell, next(i)};
    return true;
  });
  if (found.cell < 0) reject("a segment passes through a point");
  return found;
}

std::vector<std::array<int, 2>> PlanarMesh::crossed_sides(int from, int to) const {
  std::vector<std::array<int, 2>> sides;
  Side side = first_crossed(from, to);
  for (;;) {
    const Cell& cell = cells_[side.cell];
    if (cell.barrier[side.k] >= 0) reject("two segments cross");
    sides.push_back({cell.vertex[side.k], cell.vertex[next(side.k)]});
    const Side far = beyond(side);
    const int y = cells_[far.cell].vertex[last(far.k)];
    if (y == to) return sides;
    const int turn = orientation(from, to, y);
    if (turn == 0) reject("a segment passes through a point");
    side = {far.cell, turn > 0 ? next(far.k) : last(far.k)};
  }
}

// Flips what crosses the segment away (Sloan, "A fast algorithm for generating constrained Delaunay triangulations",
// 1993).
void PlanarMesh::clear_way(int from, int to) {
  const std::vector<std::array<int, 2>> crossed = crossed_sides(from, to);
  std::deque<std::array<int, 2>> waiting(crossed.begin(), crossed.end());
  std::vector<std::array<int, 2>> made;
  std::size_t budget = 100 + 10 * waiting.size() * waiting.size();
  while (!waiting.empty()) {
    if (budget-- == 0) reject("a segment does not fit");
    const auto [u, w] = waiting.front();
    waiting.pop_front();
    const Side side = side_between(u, w);
    if (!can_flip(side)) {
      waiting.push_back({u, w});
      continue;
    }
    flip(side);
    const int y = cells_[side.cell].vertex[1], x = cells_[side.cell].vertex[2];
    const bool touches = x == from || x == to || y == from || y == to;
    const bool crosses = !touches && orientation(from, to, x) * orientation(from, to, y) < 0;
    (crosses ? waiting.push_back({x, y}) : made.push_back({x, y}));
  }
  std::vector<Side> open;
  const Side own = side_between(from, to);
  if (own.cell < 0) reject("a segment does not fit");
  cells_[own.cell].barrier[own.k] = 0;
  const Side far = beyond(own);
  cells_[far.cell].barrier[far.k] = 0;
  for (const auto& [x, y] : made) {
    const Side side = side_between(x, y);
    if (side.cell >= 0) open.push_back(side);
  }
  restore(open);
}

void PlanarMesh::add_barrier(int from, int to, int number) {
  Side side = side_between(from, to);
  if (side.cell < 0) {
    clear_way(from, to);
    side = side_between(from, to);
    cells_[side.cell].barrier[side.k] = -1;
  }
  if (cells_[side.cell].across[side.k] < 0 || cells_[side.cell].barrier[side.k] >= 0) reject("two segments coincide");
  cells_[side.cell].barrier[side.k] = number;
  const Side far = beyond(side);
  cells_[far.cell].barrier[far.k] = number;
}

}  // namespace sunder::geometry::detail
