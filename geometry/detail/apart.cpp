#include "geometry/detail/apart.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include <tbb/parallel_sort.h>

#include "core/error.h"
#include "core/random.h"
#include "geometry/detail/embedding.h"

namespace sunder::geometry::detail {
namespace {

constexpr double kDistance = 1e-9;  // of the body's size: far above rounding, far below what anyone sees
constexpr int kAttempts = 40;

bool less(const Vec3& a, const Vec3& b) { return std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end()); }

std::vector<int> used_vertices(const TriangleMesh& mesh) {
  std::vector<char> used(mesh.vertices.size(), false);
  for (const Triangle& face : mesh.faces) {
    for (const int vertex : face) used[vertex] = true;
  }
  std::vector<int> result;
  for (int i = 0; i < static_cast<int>(used.size()); ++i) {
    if (used[i]) result.push_back(i);
  }
  return result;
}

/// Vertices that share their position with another one.
std::vector<char> coincident_vertices(const TriangleMesh& mesh) {
  std::vector<int> order = used_vertices(mesh);
  const std::vector<Vec3>& x = mesh.vertices;
  tbb::parallel_sort(order.begin(), order.end(), [&](int a, int b) { return x[a] != x[b] ? less(x[a], x[b]) : a < b; });
  std::vector<char> result(x.size(), false);
  for (std::size_t i = 1; i < order.size(); ++i) {
    if (x[order[i]] == x[order[i - 1]]) result[order[i]] = result[order[i - 1]] = true;
  }
  return result;
}

/// The faces around a vertex, by the vertex after it in the face.
struct Corner {
  int last;
  Vec3 normal;
};
using Fan = std::map<int, Corner>;

// The solid angle of the material in a fan: the area of a spherical polygon by its inner angles, which are those
// between the faces.
double solid_angle(const TriangleMesh& mesh, int vertex, const Fan& fan) {
  double sum = 0;
  for (const auto& [next, corner] : fan) {
    const Vec3 edge = (mesh.vertices[corner.last] - mesh.vertices[vertex]).normalized();
    // The face beyond lies to the left of this edge.
    const Vec3 &right = corner.normal, &left = fan.at(corner.last).normal;
    sum += std::numbers::pi - std::atan2(left.cross(right).dot(edge), left.dot(right));
  }
  return sum - (static_cast<double>(fan.size()) - 2) * std::numbers::pi;
}

// Into the material if it fills less than half of the space around the vertex, else out of it.
Vec3 direction(const TriangleMesh& mesh, int vertex, const Fan& fan) {
  Vec3 outward = Vec3::Zero();
  for (const auto& [next, corner] : fan) {
    const Vec3 a = mesh.vertices[next] - mesh.vertices[vertex], b = mesh.vertices[corner.last] - mesh.vertices[vertex];
    outward += corner.normal * std::atan2(a.cross(b).norm(), a.dot(b));
  }
  return solid_angle(mesh, vertex, fan) < 2 * std::numbers::pi ? Vec3(-outward.normalized())
                                                               : Vec3(outward.normalized());
}

// More and more sideways, and less far.
Vec3 another_direction(const Vec3& first, int vertex, int attempt) {
  const auto random = [&](int stream) { return 2 * random_unit(attempt, stream, vertex) - 1; };
  const double share = static_cast<double>(attempt) / kAttempts;
  return (first + share * Vec3(random(0), random(1), random(2))) * (0.6 + 0.4 * random(3));
}

std::map<int, Fan> fans_of(const TriangleMesh& mesh, const std::vector<char>& wanted) {
  std::map<int, Fan> fans;
  for (const Triangle& face : mesh.faces) {
    const Vec3& a = mesh.vertices[face[0]];
    const Vec3 normal = (mesh.vertices[face[1]] - a).cross(mesh.vertices[face[2]] - a).normalized();
    for (int k = 0; k < 3; ++k) {
      if (wanted[face[k]]) fans[face[k]][face[(k + 1) % 3]] = {face[(k + 2) % 3], normal};
    }
  }
  return fans;
}

}  // namespace

bool has_coincident_vertices(const TriangleMesh& mesh) {
  const std::vector<char> coincident = coincident_vertices(mesh);
  return std::find(coincident.begin(), coincident.end(), true) != coincident.end();
}

TriangleMesh moved_apart(const TriangleMesh& mesh) {
  const std::map<int, Fan> fans = fans_of(mesh, coincident_vertices(mesh));
  const double distance = kDistance * bounds(mesh).diagonal().norm();
  std::map<int, int> tried;  // per vertex
  TriangleMesh result = mesh;
  for (const auto& [vertex, fan] : fans) {
    result.vertices[vertex] += distance * direction(mesh, vertex, fan);
    tried[vertex] = 0;
  }
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    const std::vector<char> meets = meeting_faces(result, BoxTree(result.vertices, result.faces));
    if (std::find(meets.begin(), meets.end(), true) == meets.end()) return result;
    std::vector<char> again(mesh.vertices.size(), false);
    for (std::size_t face = 0; face < meets.size(); ++face) {
      for (const int vertex : mesh.faces[face]) again[vertex] |= meets[face];
    }
    const auto moves = [&](const auto& entry) { return again[entry.first] != 0; };
    if (std::none_of(fans.begin(), fans.end(), moves)) break;  // the faces meet elsewhere
    for (const auto& [vertex, fan] : fans) {
      if (!again[vertex]) continue;
      result.vertices[vertex] =
          mesh.vertices[vertex] + distance * another_direction(direction(mesh, vertex, fan), vertex, ++tried[vertex]);
    }
  }
  throw Error(ErrorKind::mesh, "the body intersects itself, or has coincident vertices that cannot be moved apart");
}

}  // namespace sunder::geometry::detail
