#include "geometry/surface_distance.h"

#include <algorithm>
#include <utility>

#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/AABB_triangle_primitive.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <tbb/parallel_for.h>

#include "core/error.h"

namespace sunder::geometry {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Triangles = std::vector<Kernel::Triangle_3>;
using Primitive = CGAL::AABB_triangle_primitive<Kernel, Triangles::const_iterator>;
using Tree = CGAL::AABB_tree<CGAL::AABB_traits<Kernel, Primitive>>;

Kernel::Point_3 point_of(const Vec3& x) { return {x.x(), x.y(), x.z()}; }

// Vertices, each once, and centres of faces.
std::vector<Vec3> probes(const TriangleMesh& mesh) {
  std::vector<char> used(mesh.vertices.size(), 0);
  std::vector<Vec3> points;
  for (const Triangle& face : mesh.faces) {
    Vec3 sum = Vec3::Zero();
    for (const int vertex : face) {
      const Vec3& x = mesh.vertices[vertex];
      if (!std::exchange(used[vertex], 1)) points.push_back(x);
      sum += x;
    }
    points.push_back(sum / 3);
  }
  return points;
}

double one_way(const TriangleMesh& from, const TriangleMesh& to) {
  double largest = 0;
  for (const SurfacePoint& point : nearest_on(to, probes(from))) largest = std::max(largest, point.distance);
  return largest;
}

}  // namespace

std::vector<SurfacePoint> nearest_on(const TriangleMesh& surface, std::span<const Vec3> points) {
  Triangles triangles;
  std::vector<int> face_of;
  for (std::size_t f = 0; f < surface.faces.size(); ++f) {
    const auto& [a, b, c] = surface.faces[f];
    const Kernel::Triangle_3 triangle(point_of(surface.vertices[a]), point_of(surface.vertices[b]),
                                      point_of(surface.vertices[c]));
    if (triangle.is_degenerate()) continue;
    triangles.push_back(triangle);
    face_of.push_back(static_cast<int>(f));
  }
  if (triangles.empty()) throw Error(ErrorKind::mesh, "the surface has no area");
  Tree tree(triangles.begin(), triangles.end());
  tree.build();
  tree.accelerate_distance_queries();
  std::vector<SurfacePoint> result(points.size());
  tbb::parallel_for(std::size_t{0}, points.size(), [&](std::size_t i) {
    const auto [nearest, triangle] = tree.closest_point_and_primitive(point_of(points[i]));
    result[i].face = face_of[static_cast<std::size_t>(triangle - triangles.cbegin())];
    result[i].point = {nearest.x(), nearest.y(), nearest.z()};
    result[i].distance = (result[i].point - points[i]).norm();
  });
  return result;
}

double hausdorff_distance(const TriangleMesh& a, const TriangleMesh& b) {
  return std::max(one_way(a, b), one_way(b, a));
}

}  // namespace sunder::geometry
