#include "geometry/detail/edges.h"

#include <algorithm>

namespace sunder::geometry::detail {
namespace {

struct Entry {
  int high;
  HalfEdge side;
};

// All half-edges, grouped by their lower vertex and sorted by the higher one.
std::vector<Entry> sorted_entries(const std::vector<Triangle>& faces, int vertex_count) {
  std::vector<int> first(vertex_count + 1, 0);
  for (const Triangle& face : faces) {
    for (int k = 0; k < 3; ++k) ++first[std::min(face[k], face[(k + 1) % 3]) + 1];
  }
  for (int i = 0; i < vertex_count; ++i) first[i + 1] += first[i];
  std::vector<Entry> entries(3 * faces.size());
  std::vector<int> next(first.begin(), first.end() - 1);
  for (int face = 0; face < static_cast<int>(faces.size()); ++face) {
    for (int k = 0; k < 3; ++k) {
      const int a = faces[face][k], b = faces[face][(k + 1) % 3];
      entries[next[std::min(a, b)]++] = {std::max(a, b), {face, k, a < b}};
    }
  }
  const auto by_high = [](const Entry& a, const Entry& b) { return a.high < b.high; };
  for (int i = 0; i < vertex_count; ++i) {
    std::stable_sort(entries.begin() + first[i], entries.begin() + first[i + 1], by_high);
  }
  return entries;
}

}  // namespace

Edges edges_of(const std::vector<Triangle>& faces, int vertex_count) {
  Edges edges;
  edges.of_face.resize(faces.size());
  for (const auto& [high, side] : sorted_entries(faces, vertex_count)) {
    const Triangle& face = faces[side.face];
    const int low = std::min(face[side.corner], face[(side.corner + 1) % 3]);
    if (edges.ends.empty() || edges.ends.back() != std::array<int, 2>{low, high}) {
      edges.ends.push_back({low, high});
      edges.first.push_back(static_cast<int>(edges.sides.size()));
    }
    edges.of_face[side.face][side.corner] = edges.count() - 1;
    edges.sides.push_back(side);
  }
  edges.first.push_back(static_cast<int>(edges.sides.size()));
  return edges;
}

}  // namespace sunder::geometry::detail
