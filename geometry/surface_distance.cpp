#include "geometry/surface_distance.h"

#include <algorithm>
#include <array>
#include <bit>
#include <unordered_map>
#include <utility>

#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/AABB_triangle_primitive.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <tbb/parallel_for.h>

#include "core/error.h"
#include "core/random.h"

namespace sunder::geometry {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Triangles = std::vector<Kernel::Triangle_3>;
using Primitive = CGAL::AABB_triangle_primitive<Kernel, Triangles::const_iterator>;
using Tree = CGAL::AABB_tree<CGAL::AABB_traits<Kernel, Primitive>>;

Kernel::Point_3 point_of(const Vec3& x) { return {x.x(), x.y(), x.z()}; }

struct PositionHash {
  std::size_t operator()(const std::array<double, 3>& x) const {
    std::size_t hash = 0;
    for (const double value : x) hash = mix(hash ^ std::bit_cast<std::uint64_t>(value));
    return hash;
  }
};

// Numbers positions, equal ones alike.
class Positions {
 public:
  int number(const Vec3& x) {
    return numbers_.try_emplace({x.x(), x.y(), x.z()}, static_cast<int>(numbers_.size())).first->second;
  }

 private:
  std::unordered_map<std::array<double, 3>, int, PositionHash> numbers_;
};

using Corners = std::array<int, 3>;

std::vector<Corners> numbered(const TriangleMesh& mesh, Positions& positions) {
  std::vector<Corners> faces;
  for (const auto& [a, b, c] : mesh.faces) {
    Corners corners = {positions.number(mesh.vertices[a]), positions.number(mesh.vertices[b]),
                       positions.number(mesh.vertices[c])};
    std::sort(corners.begin(), corners.end());
    faces.push_back(corners);
  }
  return faces;
}

// Vertices and centres of the faces that `known` has not; those that it has are at no distance.
std::vector<Vec3> probes(const TriangleMesh& mesh, const std::vector<Corners>& faces, std::vector<Corners> known) {
  std::sort(known.begin(), known.end());
  std::vector<char> used(mesh.vertices.size(), 0);
  std::vector<Vec3> points;
  for (std::size_t f = 0; f < faces.size(); ++f) {
    if (std::binary_search(known.begin(), known.end(), faces[f])) continue;
    Vec3 sum = Vec3::Zero();
    for (const int vertex : mesh.faces[f]) {
      const Vec3& x = mesh.vertices[vertex];
      if (!std::exchange(used[vertex], 1)) points.push_back(x);
      sum += x;
    }
    points.push_back(sum / 3);
  }
  return points;
}

double largest_distance(const TriangleMesh& surface, const std::vector<Vec3>& points) {
  double largest = 0;
  if (points.empty()) return largest;
  for (const SurfacePoint& point : nearest_on(surface, points)) largest = std::max(largest, point.distance);
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
  Positions positions;
  const std::vector<Corners> faces_a = numbered(a, positions), faces_b = numbered(b, positions);
  return std::max(largest_distance(b, probes(a, faces_a, faces_b)), largest_distance(a, probes(b, faces_b, faces_a)));
}

}  // namespace sunder::geometry
