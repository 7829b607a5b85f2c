#include "tests/geometry/delaunay_regions.h"

#include <algorithm>
#include <array>
#include <map>
#include <utility>

#include <CGAL/Delaunay_triangulation_3.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_vertex_base_with_info_3.h>

#include "core/random.h"
#include "geometry/detail/inside.h"

namespace sunder::geometry {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using VertexBase = CGAL::Triangulation_vertex_base_with_info_3<int, Kernel>;
using Delaunay = CGAL::Delaunay_triangulation_3<
    Kernel, CGAL::Triangulation_data_structure_3<VertexBase, CGAL::Delaunay_triangulation_cell_base_3<Kernel>>>;

// Seeds that close the cells of all others: the directions of a 3 x 3 x 3 grid, three diagonals away.
std::vector<Vec3> helpers(const Box& box) {
  std::vector<Vec3> result;
  for (int i = 0; i < 27; ++i) {
    const Vec3 direction(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1);
    // Not all on one sphere.
    if (i != 13) result.push_back(box.center() + (3 + 0.01 * i) * box.diagonal().norm() * direction.normalized());
  }
  return result;
}

Delaunay triangulate(const Box& box, const std::vector<Vec3>& seeds) {
  std::vector<std::pair<Kernel::Point_3, int>> points;
  for (std::size_t i = 0; i < seeds.size(); ++i) {
    points.push_back({{seeds[i].x(), seeds[i].y(), seeds[i].z()}, static_cast<int>(i)});
  }
  int helper = 0;
  for (const Vec3& x : helpers(box)) points.push_back({{x.x(), x.y(), x.z()}, --helper});
  return Delaunay(points.begin(), points.end());
}

// CGAL hands cells out in an order that depends on addresses and on its random numbers. A cell is known by its corners.
using CellKey = std::array<int, 4>;
using VertexOfCell = std::map<CellKey, std::pair<Vec3, int>>;

CellKey key_of(Delaunay::Cell_handle cell) {
  CellKey key;
  for (int k = 0; k < 4; ++k) key[k] = cell->vertex(k)->info();
  std::sort(key.begin(), key.end());
  return key;
}

Vec3 dual_of(Delaunay::Cell_handle cell) {
  std::array<std::pair<int, Kernel::Point_3>, 4> corners;
  for (int k = 0; k < 4; ++k) corners[k] = {cell->vertex(k)->info(), cell->vertex(k)->point()};
  std::sort(corners.begin(), corners.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  const auto x = CGAL::circumcenter(corners[0].second, corners[1].second, corners[2].second, corners[3].second);
  return {x.x(), x.y(), x.z()};
}

// The cells around an edge, in turn; empty if one is infinite.
std::vector<CellKey> cells_around(const Delaunay& delaunay, const Delaunay::Edge& edge, VertexOfCell& vertices) {
  std::vector<CellKey> result;
  auto cell = delaunay.incident_cells(edge);
  const auto start = cell;
  do {
    if (delaunay.is_infinite(cell)) return {};
    result.push_back(key_of(cell));
    if (!vertices.contains(result.back())) vertices[result.back()] = {dual_of(cell), -1};
  } while (++cell != start);
  return result;
}

Vec3 normal_of(const std::vector<Vec3>& vertices, const std::vector<int>& loop) {
  Vec3 normal = Vec3::Zero();
  for (std::size_t i = 1; i + 1 < loop.size(); ++i) {
    normal += (vertices[loop[i]] - vertices[loop[0]]).cross(vertices[loop[i + 1]] - vertices[loop[0]]);
  }
  return normal;
}

}  // namespace

RegionBoundary delaunay_regions(const Box& box, const std::vector<Vec3>& seeds, const std::vector<int>& region_of) {
  const Delaunay delaunay = triangulate(box, seeds);
  VertexOfCell vertices;
  std::map<std::pair<int, int>, std::vector<CellKey>> loops;  // by seeds
  for (auto edge = delaunay.finite_edges_begin(); edge != delaunay.finite_edges_end(); ++edge) {
    const int i = edge->first->vertex(edge->second)->info(), j = edge->first->vertex(edge->third)->info();
    if (i < 0 || j < 0 || region_of[i] == region_of[j]) continue;
    std::vector<CellKey> loop = cells_around(delaunay, *edge, vertices);
    if (!loop.empty()) loops[std::minmax(i, j)] = std::move(loop);
  }
  RegionBoundary result;
  result.region_count = 1 + *std::max_element(region_of.begin(), region_of.end());
  for (auto& [key, vertex] : vertices) {
    vertex.second = static_cast<int>(result.vertices.size());
    result.vertices.push_back(vertex.first);
  }
  for (const auto& [sides, cells] : loops) {
    const auto [a, b] = sides;
    RegionBoundary::Face face{{}, region_of[a], region_of[b]};
    for (const CellKey& cell : cells) face.loop.push_back(vertices[cell].second);
    // Turned so that the normal points from a to b.
    if (normal_of(result.vertices, face.loop).dot(seeds[b] - seeds[a]) < 0) {
      std::reverse(face.loop.begin(), face.loop.end());
    }
    std::rotate(face.loop.begin(), std::min_element(face.loop.begin(), face.loop.end()), face.loop.end());
    result.faces.push_back(face);
  }
  return result;
}

std::vector<Vec3> points_inside(const TriangleMesh& body, int count, std::uint64_t seed) {
  const detail::InsideTest inside(body);
  const Box box = bounds(body);
  std::vector<Vec3> result;
  for (std::uint64_t i = 0; static_cast<int>(result.size()) < count; ++i) {
    Vec3 x;
    for (int axis = 0; axis < 3; ++axis) {
      x[axis] = box.min()[axis] + box.diagonal()[axis] * random_unit(seed, static_cast<std::uint64_t>(axis), i);
    }
    if (inside(x)) result.push_back(x);
  }
  return result;
}

std::vector<int> grown_regions(const std::vector<Vec3>& seeds, int regions) {
  Box box;
  for (const Vec3& x : seeds) box.extend(x);
  const Delaunay delaunay = triangulate(box, seeds);
  std::vector<std::vector<int>> neighbours(seeds.size());
  for (auto edge = delaunay.finite_edges_begin(); edge != delaunay.finite_edges_end(); ++edge) {
    const int a = edge->first->vertex(edge->second)->info(), b = edge->first->vertex(edge->third)->info();
    if (a >= 0 && b >= 0) neighbours[a].push_back(b), neighbours[b].push_back(a);
  }
  for (std::vector<int>& list : neighbours) std::sort(list.begin(), list.end());
  // Every region takes a free neighbour of its cells in turn.
  std::vector<int> region(seeds.size(), -1);
  std::vector<std::vector<int>> members(regions);
  for (int i = 0; i < regions; ++i) region[i] = i, members[i] = {i};
  for (bool grew = true; grew;) {
    grew = false;
    for (int i = 0; i < regions; ++i) {
      int taken = -1;
      for (const int member : members[i]) {
        for (const int next : neighbours[member]) {
          if (taken < 0 && region[next] < 0) taken = next;
        }
      }
      if (taken < 0) continue;
      region[taken] = i;
      members[i].push_back(taken);
      grew = true;
    }
  }
  return region;
}

RegionBoundary cell_regions(const TriangleMesh& body, int regions, int cells_each, std::uint64_t seed) {
  const std::vector<Vec3> seeds = points_inside(body, regions * cells_each, seed);
  return delaunay_regions(bounds(body), seeds, grown_regions(seeds, regions));
}

}  // namespace sunder::geometry
