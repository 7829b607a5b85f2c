#include "geometry/detail/clean.h"

#include <algorithm>
#include <cstdlib>
#include <map>
#include <numeric>

#include "geometry/detail/topology.h"

namespace sunder::geometry::detail {
namespace {

// Nearly equal vertices on the rim of an open mesh are welded up to this share of the box diagonal.
constexpr double kSeam = 1e-6;

int open_sides(const TriangleMesh& mesh) {
  int count = 0;
  for_each_edge(sorted_sides(mesh.faces), [&](auto first, auto last) { count += last - first == 1; });
  return count;
}

TriangleMesh without_unusable_faces(const TriangleMesh& mesh) {
  const int count = static_cast<int>(mesh.vertices.size());
  const auto unusable = [&](const Triangle& face) {
    return std::any_of(face.begin(), face.end(),
                       [&](int i) { return i < 0 || i >= count || !mesh.vertices[i].allFinite(); }) ||
           names_a_vertex_twice(face);
  };
  TriangleMesh result = mesh;
  std::erase_if(result.faces, unusable);
  return compacted(result);
}

// The corners in a rotation-free order, and +1 or -1 for the way round.
std::pair<Triangle, int> unoriented(const Triangle& face) {
  Triangle key = face;
  std::sort(key.begin(), key.end());
  const auto first = std::find(face.begin(), face.end(), key[0]) - face.begin();
  return {key, face[(first + 1) % 3] == key[1] ? 1 : -1};
}

TriangleMesh without_repeated_faces(const TriangleMesh& mesh) {
  std::map<Triangle, int> balance;
  for (const Triangle& face : mesh.faces) {
    const auto [key, way] = unoriented(face);
    balance[key] += way;
  }
  const auto walls = std::count_if(balance.begin(), balance.end(), [](const auto& entry) { return entry.second == 0; });
  const bool two_sided = 2 * static_cast<std::size_t>(walls) > balance.size();
  std::map<Triangle, bool> done;
  TriangleMesh result{mesh.vertices, {}};
  for (const Triangle& face : mesh.faces) {
    const auto [key, way] = unoriented(face);
    const bool keep = balance[key] * way > 0 || (balance[key] == 0 && two_sided);
    if (keep && !done[key]) {
      result.faces.push_back(face);
      done[key] = true;
    }
  }
  return result;
}

}  // namespace

std::string step(const std::string& verb, std::size_t count, const std::string& one, const std::string& many) {
  return verb + " " + std::to_string(count) + " " + (count == 1 ? one : many);
}

TriangleMesh compacted(const TriangleMesh& mesh) {
  std::vector<int> index(mesh.vertices.size(), -1);
  for (const Triangle& face : mesh.faces) {
    for (const int vertex : face) index[vertex] = 0;
  }
  TriangleMesh result{{}, mesh.faces};
  for (std::size_t i = 0; i < index.size(); ++i) {
    if (index[i] < 0) continue;
    index[i] = static_cast<int>(result.vertices.size());
    result.vertices.push_back(mesh.vertices[i]);
  }
  for (Triangle& face : result.faces) {
    for (int& vertex : face) vertex = index[vertex];
  }
  return result;
}

bool names_a_vertex_twice(const Triangle& face) {
  return face[0] == face[1] || face[1] == face[2] || face[2] == face[0];
}

std::vector<int> coincident(const std::vector<Vec3>& vertices, double tolerance) {
  // Sweep along a direction that is no symmetry of usual meshes, so that few vertices share a place on it.
  const Vec3 direction = Vec3(1, 0.618, 0.367).normalized();
  std::vector<std::pair<double, int>> order;
  for (int i = 0; i < static_cast<int>(vertices.size()); ++i) order.emplace_back(direction.dot(vertices[i]), i);
  std::sort(order.begin(), order.end());
  DisjointSets same(static_cast<int>(order.size()));
  for (std::size_t i = 0; i < order.size(); ++i) {
    const Vec3& at = vertices[order[i].second];
    for (std::size_t j = i + 1; j < order.size() && order[j].first - order[i].first <= tolerance; ++j) {
      if ((vertices[order[j].second] - at).norm() <= tolerance) same.unite(order[i].second, order[j].second);
    }
  }
  std::vector<int> result(vertices.size());
  for (std::size_t i = 0; i < result.size(); ++i) result[i] = same.find(static_cast<int>(i));
  return result;
}

TriangleMesh welded(const TriangleMesh& mesh, double tolerance) {
  const std::vector<int> same = coincident(mesh.vertices, tolerance);
  TriangleMesh result = mesh;
  for (Triangle& face : result.faces) {
    for (int& vertex : face) vertex = same[vertex];
  }
  std::erase_if(result.faces, names_a_vertex_twice);
  return compacted(result);
}

TriangleMesh cleaned(const TriangleMesh& mesh, Steps& steps) {
  const auto adopt = [&](TriangleMesh& current, TriangleMesh next, const std::string& verb, bool vertices) {
    const std::size_t dropped =
        vertices ? current.vertices.size() - next.vertices.size() : current.faces.size() - next.faces.size();
    if (dropped > 0)
      steps.push_back(vertices ? step(verb, dropped, "vertex", "vertices") : step(verb, dropped, "face", "faces"));
    current = std::move(next);
  };
  TriangleMesh result = without_unusable_faces(mesh);
  if (result.faces.size() < mesh.faces.size()) {
    steps.push_back(step("dropped", mesh.faces.size() - result.faces.size(), "unusable face", "unusable faces"));
  }
  adopt(result, welded(result, 0), "welded", true);
  adopt(result, without_repeated_faces(result), "dropped repeated", false);
  const int open = open_sides(result);
  if (open > 0) {
    TriangleMesh sewn = welded(result, kSeam * bounds(result).diagonal().norm());
    if (open_sides(sewn) < open) adopt(result, std::move(sewn), "closed seams by welding", true);
  }
  return compacted(result);
}

}  // namespace sunder::geometry::detail
