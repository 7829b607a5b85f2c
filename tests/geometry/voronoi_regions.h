#pragma once
/// Region boundaries for the cut tests: the Voronoi cells of a few seeds in a box, made by clipping the box with
/// bisectors.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <vector>

#include "core/random.h"
#include "geometry/cut.h"

namespace sunder::geometry {

struct CellFace {
  int neighbour;  // -1: the box
  std::vector<Vec3> loop;
};
using Cell = std::vector<CellFace>;

inline Cell box_cell(const Box& box) {
  // A corner's bits are its axes: 1 x, 2 y, 4 z.
  constexpr std::array<std::array<int, 4>, 6> sides = {
      {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}}};
  Cell cell;
  for (const auto& side : sides) {
    CellFace face{-1, {}};
    for (const int corner : side) face.loop.push_back(box.corner(static_cast<Box::CornerType>(corner)));
    cell.push_back(face);
  }
  return cell;
}

/// The points of a convex polygon with the given normal, in turn.
inline std::vector<Vec3> turned(std::vector<Vec3> points, const Vec3& normal) {
  Vec3 center = Vec3::Zero();
  for (const Vec3& x : points) center += x / static_cast<double>(points.size());
  const Vec3 u = normal.unitOrthogonal(), v = normal.normalized().cross(u);
  const auto angle = [&](const Vec3& x) { return std::atan2((x - center).dot(v), (x - center).dot(u)); };
  std::sort(points.begin(), points.end(), [&](const Vec3& a, const Vec3& b) { return angle(a) < angle(b); });
  return points;
}

/// Keeps what lies at normal . x <= height and closes it with a face to `neighbour`.
inline Cell clipped(const Cell& cell, const Vec3& normal, double height, int neighbour, double tolerance) {
  Cell result;
  std::vector<Vec3> rim;
  for (const CellFace& face : cell) {
    CellFace kept{face.neighbour, {}};
    for (std::size_t i = 0; i < face.loop.size(); ++i) {
      const Vec3 &a = face.loop[i], &b = face.loop[(i + 1) % face.loop.size()];
      const double da = normal.dot(a) - height, db = normal.dot(b) - height;
      if (da <= 0) kept.loop.push_back(a);
      if ((da <= 0) == (db <= 0)) continue;
      kept.loop.push_back(a + (b - a) * (da / (da - db)));
      rim.push_back(kept.loop.back());
    }
    if (kept.loop.size() >= 3) result.push_back(kept);
  }
  std::vector<Vec3> corners;  // every corner of the rim comes from two faces
  for (const Vec3& x : rim) {
    const auto same = [&](const Vec3& y) { return (x - y).norm() < tolerance; };
    if (std::none_of(corners.begin(), corners.end(), same)) corners.push_back(x);
  }
  if (corners.size() >= 3) result.push_back({neighbour, turned(corners, normal)});
  return result;
}

/// Gives points closer than the tolerance one index.
class Welder {
 public:
  Welder(std::vector<Vec3>& vertices, double tolerance) : vertices_(vertices), tolerance_(tolerance) {}

  int operator()(const Vec3& x) {
    std::array<std::int64_t, 3> key;
    for (int corner = 0; corner < 8; ++corner) {
      for (int axis = 0; axis < 3; ++axis) key[axis] = bin(x[axis] + ((corner >> axis & 1) ? tolerance_ : -tolerance_));
      const auto found = bins_.find(key);
      if (found != bins_.end() && (vertices_[found->second] - x).norm() < tolerance_) return found->second;
    }
    const int index = static_cast<int>(vertices_.size());
    vertices_.push_back(x);
    for (int axis = 0; axis < 3; ++axis) key[axis] = bin(x[axis]);
    bins_[key] = index;
    return index;
  }

 private:
  std::int64_t bin(double x) const { return static_cast<std::int64_t>(std::floor(x / (4 * tolerance_))); }

  std::vector<Vec3>& vertices_;
  double tolerance_;
  std::map<std::array<std::int64_t, 3>, int> bins_;
};

/// Seed i belongs to region region_of[i].
inline RegionBoundary voronoi_regions(const Box& box, const std::vector<Vec3>& seeds,
                                      const std::vector<int>& region_of) {
  const double tolerance = 1e-9 * box.diagonal().norm();
  RegionBoundary result;
  result.region_count = 1 + *std::max_element(region_of.begin(), region_of.end());
  Welder weld(result.vertices, tolerance);
  for (std::size_t i = 0; i < seeds.size(); ++i) {
    Cell cell = box_cell(box);
    for (std::size_t j = 0; j < seeds.size(); ++j) {
      if (i == j) continue;
      const Vec3 normal = (seeds[j] - seeds[i]).normalized();
      cell = clipped(cell, normal, normal.dot((seeds[i] + seeds[j]) / 2), static_cast<int>(j), tolerance);
    }
    for (const CellFace& face : cell) {
      const int outside = face.neighbour < 0 ? -1 : region_of[face.neighbour];
      const bool seen_before = face.neighbour >= 0 && face.neighbour < static_cast<int>(i);
      if (outside == region_of[i] || seen_before) continue;
      RegionBoundary::Face out{{}, region_of[i], outside};
      for (const Vec3& x : face.loop) {
        const int vertex = weld(x);
        if (out.loop.empty() || (out.loop.back() != vertex && out.loop.front() != vertex)) out.loop.push_back(vertex);
      }
      if (out.loop.size() >= 3) result.faces.push_back(out);
    }
  }
  return result;
}

inline Box padded(const Box& box) {
  const Vec3 room = Vec3::Constant(0.3 * box.diagonal().norm());
  return {box.min() - room, box.max() + room};
}

/// `cells` random seeds in the body's box, joined to `regions` regions, in a box with room to spare.
inline RegionBoundary random_regions(const TriangleMesh& body, int cells, int regions, std::uint64_t seed) {
  const Box box = bounds(body);
  std::vector<Vec3> seeds(cells);
  std::vector<int> region_of(cells);
  for (int i = 0; i < cells; ++i) {
    for (int axis = 0; axis < 3; ++axis) {
      seeds[i][axis] = box.min()[axis] + box.diagonal()[axis] * random_unit(seed, axis, i);
    }
    // The first seeds are the regions' own; the others join the region of the nearest one.
    region_of[i] = i;
    if (i < regions) continue;
    const auto nearer = [&](const Vec3& a, const Vec3& b) { return (a - seeds[i]).norm() < (b - seeds[i]).norm(); };
    region_of[i] = static_cast<int>(std::min_element(seeds.begin(), seeds.begin() + regions, nearer) - seeds.begin());
  }
  return voronoi_regions(padded(box), seeds, region_of);
}

}  // namespace sunder::geometry
