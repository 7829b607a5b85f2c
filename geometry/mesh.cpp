#include "geometry/mesh.h"

#include <algorithm>
#include <utility>

namespace sunder::geometry {

Box bounds(const TriangleMesh& mesh) {
  Box box;
  for (const Vec3& vertex : mesh.vertices) box.extend(vertex);
  return box;
}

namespace {

// Twice the area long.
Vec3 area_vector(const TriangleMesh& mesh, std::size_t face) {
  const auto corner = [&](std::size_t k) { return mesh.vertices[static_cast<std::size_t>(mesh.faces[face][k])]; };
  return (corner(1) - corner(0)).cross(corner(2) - corner(0));
}

}  // namespace

double face_area(const TriangleMesh& mesh, std::size_t face) { return area_vector(mesh, face).norm() / 2; }

Vec3 face_normal(const TriangleMesh& mesh, std::size_t face) { return area_vector(mesh, face).normalized(); }

TriangleMesh transformed(const TriangleMesh& mesh, const Mat3& linear, const Vec3& offset) {
  TriangleMesh result = mesh;
  for (Vec3& vertex : result.vertices) vertex = (linear * vertex + offset).eval();
  if (linear.determinant() < 0) {
    for (Triangle& face : result.faces) std::swap(face[1], face[2]);
  }
  return result;
}

namespace {

/// A face's corner at `vertex`, between the edges to `next` and to `last`.
struct Corner {
  int vertex, next, last;
  auto key() const { return std::pair(vertex, next); }
};

/// All corners of one vertex, sorted by `next`: they are one fan when walking from corner to corner visits all of them.
bool is_one_fan(const Corner* begin, const Corner* end) {
  int at = begin->next;
  for (const Corner* visited = begin; visited != end; ++visited) {
    const Corner* corner = std::lower_bound(begin, end, at, [](const Corner& c, int next) { return c.next < next; });
    if (corner == end || corner->next != at) return false;
    at = corner->last;
    if (at == begin->next) return visited + 1 == end;
  }
  return false;
}

}  // namespace

bool is_closed_two_manifold(const TriangleMesh& mesh) {
  std::vector<Corner> corners;
  corners.reserve(3 * mesh.faces.size());
  for (const auto& [a, b, c] : mesh.faces) {
    corners.push_back({a, b, c});
    corners.push_back({b, c, a});
    corners.push_back({c, a, b});
  }
  std::sort(corners.begin(), corners.end(), [](const Corner& x, const Corner& y) { return x.key() < y.key(); });
  const auto same_edge = [](const Corner& x, const Corner& y) { return x.key() == y.key(); };
  if (std::adjacent_find(corners.begin(), corners.end(), same_edge) != corners.end()) return false;
  for (std::size_t begin = 0, end = 0; begin < corners.size(); begin = end) {
    while (end < corners.size() && corners[end].vertex == corners[begin].vertex) ++end;
    if (!is_one_fan(&corners[begin], &corners[begin] + (end - begin))) return false;
  }
  return !corners.empty();
}

}  // namespace sunder::geometry
