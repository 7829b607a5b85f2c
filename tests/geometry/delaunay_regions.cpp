#include "tests/geometry/delaunay_regions.h"

#include <algorithm>
#include <limits>
#include <unordered_map>

#include <CGAL/Delaunay_triangulation_3.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Random.h>
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
  // CGAL inserts points in a random order that depends on what the thread did before.
  CGAL::get_default_random() = CGAL::Random(0);
  std::vector<std::pair<Kernel::Point_3, int>> points;
  for (std::size_t i = 0; i < seeds.size(); ++i) {
    points.push_back({{seeds[i].x(), seeds[i].y(), seeds[i].z()}, static_cast<int>(i)});
  }
  for (const Vec3& x : helpers(box)) points.push_back({{x.x(), x.y(), x.z()}, -1});
  return Delaunay(points.begin(), points.end());
}

}  // namespace

RegionBoundary delaunay_regions(const Box& box, const std::vector<Vec3>& seeds, const std::vector<int>& region_of) {
  const Delaunay delaunay = triangulate(box, seeds);
  RegionBoundary result;
  result.region_count = 1 + *std::max_element(region_of.begin(), region_of.end());
  std::unordered_map<Delaunay::Cell_handle, int> vertex_of;
  const auto vertex = [&](Delaunay::Cell_handle cell) {
    const auto [found, added] = vertex_of.emplace(cell, static_cast<int>(result.vertices.size()));
    if (added) {
      const auto x = delaunay.dual(cell);
      result.vertices.push_back({x.x(), x.y(), x.z()});
    }
    return found->second;
  };
  for (auto edge = delaunay.finite_edges_begin(); edge != delaunay.finite_edges_end(); ++edge) {
    const int a = edge->first->vertex(edge->second)->info(), b = edge->first->vertex(edge->third)->info();
    if (a < 0 || b < 0 || region_of[a] == region_of[b]) continue;
    RegionBoundary::Face face{{}, region_of[a], region_of[b]};
    bool finite = true;
    auto cell = delaunay.incident_cells(*edge);
    const auto start = cell;
    do {
      finite &= !delaunay.is_infinite(cell);
      if (finite) face.loop.push_back(vertex(cell));
    } while (finite && ++cell != start);
    if (!finite) continue;
    // Turned so that the normal points from a to b.
    Vec3 normal = Vec3::Zero();
    const Vec3& apex = result.vertices[face.loop[0]];
    for (std::size_t i = 1; i + 1 < face.loop.size(); ++i) {
      normal += (result.vertices[face.loop[i]] - apex).cross(result.vertices[face.loop[i + 1]] - apex);
    }
    if (normal.dot(seeds[b] - seeds[a]) < 0) std::reverse(face.loop.begin(), face.loop.end());
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
