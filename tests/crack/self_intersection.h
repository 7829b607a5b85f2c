#pragma once
/// Does a complex of triangles intersect itself? Written apart from the product's own check, for generic positions.
#include <algorithm>
#include <cmath>
#include <vector>

#include "geometry/cut.h"

namespace sunder::crack::test {

class SelfIntersection {
 public:
  explicit SelfIntersection(const geometry::RegionBoundary& boundary) : boundary_(boundary) {}

  /// Pairs of faces that cross, or that share an edge and lie on each other.
  int count() const {
    struct Item {
      Box box;
      int face;
    };
    std::vector<Item> items;
    for (int f = 0; f < static_cast<int>(boundary_.faces.size()); ++f) {
      Item item{{}, f};
      for (int i = 0; i < 3; ++i) item.box.extend(corner(f, i));
      items.push_back(item);
    }
    std::sort(items.begin(), items.end(),
              [](const Item& a, const Item& b) { return a.box.min().x() < b.box.min().x(); });
    int pairs = 0;
    std::vector<const Item*> active;
    for (const Item& item : items) {
      std::erase_if(active, [&](const Item* other) { return other->box.max().x() < item.box.min().x(); });
      for (const Item* other : active)
        if (item.box.intersects(other->box)) pairs += bad(item.face, other->face);
      active.push_back(&item);
    }
    return pairs;
  }

 private:
  const Vec3& corner(int f, int i) const { return boundary_.vertices[boundary_.faces[f].loop[i % 3]]; }

  bool bad(int f, int g) const {
    int shared = 0, apex_f = 3, apex_g = 3;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) shared += boundary_.faces[f].loop[i] == boundary_.faces[g].loop[j];
    if (shared == 3) return true;
    if (shared == 2) {
      apex_f = odd_corner(f, g), apex_g = odd_corner(g, f);
      return coincide(f, apex_f, corner(g, apex_g));
    }
    for (int i = 0; i < 3; ++i)
      if (passes(f, i, g) || passes(g, i, f)) return true;
    return false;
  }

  int odd_corner(int f, int g) const {
    for (int i = 0; i < 3; ++i) {
      const std::vector<int>& loop = boundary_.faces[g].loop;
      if (std::find(loop.begin(), loop.end(), boundary_.faces[f].loop[i]) == loop.end()) return i;
    }
    return 0;
  }

  /// Do two triangles over one edge have no angle between them?
  bool coincide(int f, int apex, const Vec3& other) const {
    const Vec3& a = corner(f, apex + 1);
    const Vec3 along = (corner(f, apex + 2) - a).normalized();
    const auto across = [&](const Vec3& x) { return Vec3((x - a) - along * along.dot(x - a)).normalized(); };
    return across(corner(f, apex)).dot(across(other)) > 1 - 1e-10;
  }

  /// Does edge i of f pass through g? By the point where it meets the plane, in barycentric coordinates. An edge with
  /// an end in common with g meets the plane there and passes through nothing.
  bool passes(int f, int i, int g) const {
    for (int end = i; end < i + 2; ++end)
      for (int v : boundary_.faces[g].loop)
        if (boundary_.faces[f].loop[end % 3] == v) return false;
    const Vec3 &p = corner(f, i), &q = corner(f, i + 1), &a = corner(g, 0);
    const Vec3 u = corner(g, 1) - a, v = corner(g, 2) - a, n = u.cross(v);
    const double hp = n.dot(p - a), hq = n.dot(q - a);
    if (hp == hq || (hp > 0) == (hq > 0)) return false;
    const Vec3 r = p + (q - p) * (hp / (hp - hq)) - a;
    const double s = r.cross(v).dot(n) / n.squaredNorm(), t = u.cross(r).dot(n) / n.squaredNorm();
    return s > 0 && t > 0 && s + t < 1;
  }

  const geometry::RegionBoundary& boundary_;
};

inline int self_intersections(const geometry::RegionBoundary& boundary) { return SelfIntersection(boundary).count(); }

}  // namespace sunder::crack::test
