#include "geometry/detail/topology.h"

#include <algorithm>
#include <numeric>
#include <tuple>
#include <utility>

namespace sunder::geometry::detail {

std::vector<Side> sorted_sides(const std::vector<Triangle>& faces) {
  std::vector<Side> sides;
  sides.reserve(3 * faces.size());
  for (int face = 0; face < static_cast<int>(faces.size()); ++face) {
    for (int corner = 0; corner < 3; ++corner) {
      const int from = faces[face][corner], to = faces[face][(corner + 1) % 3];
      sides.push_back({std::min(from, to), std::max(from, to), face, corner, from < to});
    }
  }
  std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) {
    return std::tie(a.low, a.high, a.face, a.corner) < std::tie(b.low, b.high, b.face, b.corner);
  });
  return sides;
}

DisjointSets::DisjointSets(int count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), 0); }

int DisjointSets::find(int i) {
  while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
  return i;
}

void DisjointSets::unite(int i, int j) {
  const auto [low, high] = std::minmax({find(i), find(j)});
  parent_[high] = low;
}

std::vector<int> DisjointSets::labels() {
  std::vector<int> result(parent_.size());
  int count = 0;
  for (int i = 0; i < static_cast<int>(parent_.size()); ++i) result[i] = find(i) == i ? count++ : result[find(i)];
  return result;
}

std::vector<int> face_components(const std::vector<Triangle>& faces, const std::vector<Side>& sides) {
  DisjointSets sets(static_cast<int>(faces.size()));
  for_each_edge(sides, [&](auto first, auto last) {
    for (auto side = first + 1; side != last; ++side) sets.unite(first->face, side->face);
  });
  return sets.labels();
}

std::vector<TriangleMesh> split(const TriangleMesh& mesh, const std::vector<int>& component) {
  std::vector<TriangleMesh> parts;
  // Components may share a vertex: each has its own copy, the latest one is remembered with its component.
  std::vector<std::pair<int, int>> copy(mesh.vertices.size(), {-1, -1});
  std::vector<std::vector<int>> faces;
  for (int face = 0; face < static_cast<int>(mesh.faces.size()); ++face) {
    faces.resize(std::max<std::size_t>(faces.size(), component[face] + 1));
    faces[component[face]].push_back(face);
  }
  for (int part = 0; part < static_cast<int>(faces.size()); ++part) {
    TriangleMesh& out = parts.emplace_back();
    for (const int face : faces[part]) {
      Triangle& triangle = out.faces.emplace_back(mesh.faces[face]);
      for (int& vertex : triangle) {
        auto& [owner, index] = copy[vertex];
        if (owner != part) {
          owner = part;
          index = static_cast<int>(out.vertices.size());
          out.vertices.push_back(mesh.vertices[vertex]);
        }
        vertex = index;
      }
    }
  }
  return parts;
}

}  // namespace sunder::geometry::detail
