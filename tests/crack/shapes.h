#pragma once
/// Point clouds of test bodies with prescribed damage, and what tests measure on the regions that come out.
#include <cmath>
#include <functional>
#include <map>
#include <set>
#include <vector>

#include "crack/extract.h"
#include "validation/damage_cloud.h"

namespace sunder::crack::test {

using namespace setup;

/// With nodes as far apart as the points, unless the settings say otherwise.
inline Extraction run(const DamageField& field, const Box& domain = unit_cube(), Settings settings = {}) {
  SilentProgress progress;
  if (settings.node_spacing == 0) settings.node_spacing = field.spacing;
  return extract(field, domain, settings, progress);
}

inline Vec3 area_vector(const std::vector<Vec3>& polygon) {
  Vec3 sum = Vec3::Zero();
  for (std::size_t i = 2; i < polygon.size(); ++i)
    sum += (polygon[i - 1] - polygon[0]).cross(polygon[i] - polygon[0]) / 2;
  return sum;
}

/// The corners of a boundary face as seen from outside `region`.
inline std::vector<Vec3> polygon_of(const geometry::RegionBoundary& boundary,
                                    const geometry::RegionBoundary::Face& face, int region) {
  std::vector<Vec3> polygon;
  for (int v : face.loop) polygon.push_back(boundary.vertices[v]);
  if (face.inside != region) std::reverse(polygon.begin(), polygon.end());
  return polygon;
}

/// Calls visit(polygon seen from outside) for every face of the region.
template <typename Visit>
void for_each_face(const geometry::RegionBoundary& boundary, int region, Visit&& visit) {
  for (const auto& face : boundary.faces)
    if (face.inside == region || face.outside == region) visit(polygon_of(boundary, face, region));
}

/// Divergence theorem.
inline double volume(const geometry::RegionBoundary& boundary, int region) {
  double sum = 0;
  for_each_face(boundary, region, [&](const std::vector<Vec3>& polygon) {
    for (std::size_t i = 2; i < polygon.size(); ++i) sum += polygon[0].dot(polygon[i - 1].cross(polygon[i])) / 6;
  });
  return sum;
}

/// Volume of the part of a region in a box, by `columns`^2 vertical lines: exact along z, midpoint rule across.
inline double volume_in(const geometry::RegionBoundary& boundary, int region, const Box& box, int columns = 200) {
  const double dx = box.sizes().x() / columns, dy = box.sizes().y() / columns;
  double sum = 0;
  const auto add = [&](const Vec3& a, const Vec3& b, const Vec3& c) {
    const Vec3 n = (b - a).cross(c - a);
    const auto column = [&](double x, int axis, double width) { return (x - box.min()[axis]) / width - 0.5; };
    const auto low = [&](int axis, double width) {
      return std::max(0, static_cast<int>(std::ceil(column(std::min({a[axis], b[axis], c[axis]}), axis, width))));
    };
    const auto high = [&](int axis, double width) {
      return std::min(columns - 1,
                      static_cast<int>(std::floor(column(std::max({a[axis], b[axis], c[axis]}), axis, width))));
    };
    const auto side = [&](const Vec3& p, const Vec3& q, double x, double y) {
      return ((q.x() - p.x()) * (y - p.y()) - (q.y() - p.y()) * (x - p.x())) * (n.z() > 0 ? 1 : -1) > 0;
    };
    for (int i = low(0, dx); i <= high(0, dx); ++i)
      for (int j = low(1, dy); j <= high(1, dy); ++j) {
        const double x = box.min().x() + (i + 0.5) * dx, y = box.min().y() + (j + 0.5) * dy;
        if (!side(a, b, x, y) || !side(b, c, x, y) || !side(c, a, x, y)) continue;
        const double z = a.z() - (n.x() * (x - a.x()) + n.y() * (y - a.y())) / n.z();
        sum += (n.z() > 0 ? 1 : -1) * std::clamp(z, box.min().z(), box.max().z());
      }
  };
  for_each_face(boundary, region, [&](const std::vector<Vec3>& polygon) {
    for (std::size_t i = 2; i < polygon.size(); ++i) add(polygon[0], polygon[i - 1], polygon[i]);
  });
  return sum * dx * dy;
}

/// The box that the regions have to fill.
inline Box filled_box(const geometry::RegionBoundary& boundary) {
  Box box;
  for (const Vec3& v : boundary.vertices) box.extend(v);
  return box;
}

/// Every directed edge of every region once, with its opposite: written anew, independent of the product's own gate.
inline bool closed(const geometry::RegionBoundary& boundary) {
  for (int region = 0; region < boundary.region_count; ++region) {
    std::map<std::pair<int, int>, int> edges;
    for (const auto& face : boundary.faces) {
      if (face.inside != region && face.outside != region) continue;
      std::vector<int> loop = face.loop;
      if (face.inside != region) std::reverse(loop.begin(), loop.end());
      for (std::size_t i = 0; i < loop.size(); ++i) ++edges[{loop[i], loop[(i + 1) % loop.size()]}];
    }
    for (const auto& [edge, count] : edges) {
      const auto opposite = edges.find({edge.second, edge.first});
      if (count != 1 || opposite == edges.end() || opposite->second != 1) return false;
    }
  }
  return true;
}

/// V - E + F of a region's boundary, and how many closed surfaces it consists of.
struct Topology {
  int euler = 0;
  int shells = 0;
};

inline Topology topology(const geometry::RegionBoundary& boundary, int region) {
  std::map<int, int> parent;
  const std::function<int(int)> root = [&](int v) { return parent[v] == v ? v : parent[v] = root(parent[v]); };
  std::set<std::pair<int, int>> edges;
  int faces = 0;
  for (const auto& face : boundary.faces) {
    if (face.inside != region && face.outside != region) continue;
    ++faces;
    for (int v : face.loop) parent.try_emplace(v, v);
    for (std::size_t i = 0; i < face.loop.size(); ++i) {
      const int a = face.loop[i], b = face.loop[(i + 1) % face.loop.size()];
      edges.insert(std::minmax(a, b));
      parent[root(a)] = root(b);
    }
  }
  Topology result{static_cast<int>(parent.size()) - static_cast<int>(edges.size()) + faces, 0};
  for (const auto& [v, above] : parent) result.shells += root(v) == v;
  return result;
}

/// The region that holds `x`, or -1.
inline int region_at(const geometry::RegionBoundary& boundary, const Vec3& x) {
  for (int region = 0; region < boundary.region_count; ++region) {
    int winding = 0;
    for_each_face(boundary, region, [&](const std::vector<Vec3>& polygon) {
      for (std::size_t i = 2; i < polygon.size(); ++i) {
        const Vec3 &a = polygon[0], &b = polygon[i - 1], &c = polygon[i];
        const Vec3 n = (b - a).cross(c - a);
        const double up = n.z() > 0 ? 1 : -1;
        const auto side = [&](const Vec3& p, const Vec3& q) {
          return ((q.x() - p.x()) * (x.y() - p.y()) - (q.y() - p.y()) * (x.x() - p.x())) * up > 0;
        };
        if (!side(a, b) || !side(b, c) || !side(c, a)) continue;
        if (n.dot(x - a) * up < 0) winding += static_cast<int>(up);
      }
    });
    if (winding == 1) return region;
  }
  return -1;
}

/// The corners of a crack face.
inline std::vector<Vec3> polygon_of(const Extraction& result, const CrackFace& face) {
  std::vector<Vec3> polygon;
  for (const int v : face.loop) polygon.push_back(result.vertices[static_cast<std::size_t>(v)]);
  return polygon;
}

/// The part of a convex polygon in a box.
inline std::vector<Vec3> clipped(std::vector<Vec3> polygon, const Box& box) {
  for (int plane = 0; plane < 6 && !polygon.empty(); ++plane) {
    const int axis = plane / 2;
    const auto height = [&](const Vec3& x) {
      return plane % 2 ? box.max()[axis] - x[axis] : x[axis] - box.min()[axis];
    };
    std::vector<Vec3> kept;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      const Vec3 &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
      const double ha = height(a), hb = height(b);
      if (ha >= 0) kept.push_back(a);
      if ((ha >= 0) != (hb >= 0)) kept.push_back(a + ha / (ha - hb) * (b - a));
    }
    polygon = std::move(kept);
  }
  return polygon;
}

/// How far the medial faces inside a box lie from a surface.
struct Deviation {
  double rms = 0, largest = 0, area = 0;
};

template <typename Distance>
Deviation deviation(const Extraction& result, const Box& box, Distance&& distance) {
  Deviation d;
  for (const CrackFace& face : result.faces) {
    const std::vector<Vec3> polygon = clipped(polygon_of(result, face), box);
    if (face.kind == FaceKind::partial || polygon.size() < 3) continue;
    double squares = 0;
    for (const Vec3& x : polygon) {
      squares += distance(x) * distance(x) / static_cast<double>(polygon.size());
      d.largest = std::max(d.largest, std::abs(distance(x)));
    }
    const double area = area_vector(polygon).norm();
    d.area += area;
    d.rms += area * squares;
  }
  d.rms = std::sqrt(d.rms / d.area);
  return d;
}

inline int count(const Extraction& result, FaceKind kind) {
  int n = 0;
  for (const CrackFace& face : result.faces) n += face.kind == kind;
  return n;
}

}  // namespace sunder::crack::test
