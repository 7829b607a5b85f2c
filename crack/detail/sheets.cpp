#include "crack/detail/sheets.h"

namespace sunder::crack::detail {

namespace {

using Face = geometry::RegionBoundary::Face;

struct Edge {
  int a = 0, b = 0;
  int faces = 0;
  int first = 0, second = 0;  // triangles
};

std::vector<Edge> edges_of(const FineMesh& mesh) {
  IndexTable table(3 * mesh.faces.size() / 2);
  std::vector<Edge> edges;
  edges.reserve(3 * mesh.faces.size() / 2);
  for (int f = 0; f < static_cast<int>(mesh.faces.size()); ++f)
    for (int i = 0; i < 3; ++i) {
      const int a = mesh.faces[f][i], b = mesh.faces[f][(i + 1) % 3];
      const int e = table.insert(edge_key(a, b));
      if (e == static_cast<int>(edges.size())) edges.push_back({a, b, 0, f, f});
      ++edges[e].faces;
      edges[e].second = f;
    }
  return edges;
}

EdgeGraph graph_of(const std::vector<Edge>& edges, std::size_t vertices) {
  EdgeGraph graph;
  graph.start.assign(vertices + 1, 0);
  for (const Edge& e : edges) ++graph.start[e.a + 1], ++graph.start[e.b + 1];
  for (std::size_t v = 0; v < vertices; ++v) graph.start[v + 1] += graph.start[v];
  graph.neighbour.resize(2 * edges.size());
  std::vector<int> at(graph.start.begin(), graph.start.end() - 1);
  for (const Edge& e : edges) graph.neighbour[at[e.a]++] = e.b, graph.neighbour[at[e.b]++] = e.a;
  return graph;
}

bool joins_sheet(const geometry::RegionBoundary& boundary, const FineMesh& mesh, const Edge& e) {
  if (e.faces != 2) return false;
  const Face& f = boundary.faces[mesh.source[e.first]];
  const Face& g = boundary.faces[mesh.source[e.second]];
  return f.outside >= 0 && g.outside >= 0 && std::minmax(f.inside, f.outside) == std::minmax(g.inside, g.outside);
}

/// Components under the given edges, numbered by their first face.
int label(const std::vector<Edge>& edges, const std::vector<char>& joins, std::vector<int>& of_face) {
  std::vector<int> parent(of_face.size());
  for (int f = 0; f < static_cast<int>(parent.size()); ++f) parent[f] = f;
  const auto root = [&](int f) {
    while (parent[f] != f) f = parent[f] = parent[parent[f]];
    return f;
  };
  for (std::size_t e = 0; e < edges.size(); ++e) {
    if (!joins[e]) continue;
    const int a = root(edges[e].first), b = root(edges[e].second);
    parent[std::max(a, b)] = std::min(a, b);
  }
  int count = 0;
  for (int f = 0; f < static_cast<int>(parent.size()); ++f) {
    const int r = root(f);
    of_face[f] = r == f ? count++ : of_face[r];
  }
  return count;
}

}  // namespace

Sheets find_sheets(const geometry::RegionBoundary& boundary, const FineMesh& mesh, const Box& movable) {
  const std::vector<Edge> edges = edges_of(mesh);
  std::vector<char> joins(edges.size());
  for (std::size_t e = 0; e < edges.size(); ++e) joins[e] = joins_sheet(boundary, mesh, edges[e]);

  Sheets sheets;
  sheets.edges = graph_of(edges, mesh.vertices.size());
  sheets.of_face.resize(mesh.faces.size());
  sheets.count = label(edges, joins, sheets.of_face);
  sheets.flipped.resize(mesh.faces.size());
  constexpr int unseen = -2, stays = -1;
  sheets.of_vertex.assign(mesh.vertices.size(), unseen);
  for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
    const Face& face = boundary.faces[mesh.source[f]];
    sheets.flipped[f] = face.outside >= 0 && face.inside > face.outside;
    for (int v : mesh.faces[f]) {
      int& sheet = sheets.of_vertex[v];
      sheet = face.outside >= 0 && (sheet == unseen || sheet == sheets.of_face[f]) ? sheets.of_face[f] : stays;
    }
  }
  for (std::size_t e = 0; e < edges.size(); ++e)
    if (!joins[e]) sheets.of_vertex[edges[e].a] = sheets.of_vertex[edges[e].b] = stays;
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v)
    if (sheets.of_vertex[v] == unseen || !movable.contains(mesh.vertices[v])) sheets.of_vertex[v] = stays;
  return sheets;
}

}  // namespace sunder::crack::detail
