#include "crack/detail/boundary.h"

#include <algorithm>
#include <array>

#include <tbb/parallel_sort.h>

namespace sunder::crack::detail {

namespace {

using DirectedEdge = std::array<int, 3>;  // region, from, to

std::vector<DirectedEdge> directed_edges(const geometry::RegionBoundary& boundary) {
  std::vector<DirectedEdge> edges;
  for (const geometry::RegionBoundary::Face& face : boundary.faces)
    for (std::size_t i = 0; i < face.loop.size(); ++i) {
      const int from = face.loop[i], to = face.loop[(i + 1) % face.loop.size()];
      edges.push_back({face.inside, from, to});
      if (face.outside >= 0) edges.push_back({face.outside, to, from});
    }
  tbb::parallel_sort(edges.begin(), edges.end());
  return edges;
}

}  // namespace

geometry::RegionBoundary region_boundary(const std::vector<Site>& sites, const CellFaces& cells, int region_count) {
  geometry::RegionBoundary boundary;
  boundary.vertices = cells.vertices;
  boundary.region_count = region_count;
  boundary.faces.reserve(cells.faces.size());
  for (const CellFace& face : cells.faces)
    if (face.neighbour >= 0) boundary.faces.push_back({face.loop, sites[face.site].piece, sites[face.neighbour].piece});
  for (const CellFace& face : cells.faces)
    if (face.neighbour < 0) boundary.faces.push_back({face.loop, sites[face.site].piece, -1});
  return boundary;
}

bool is_closed(const geometry::RegionBoundary& boundary) {
  const std::vector<DirectedEdge> edges = directed_edges(boundary);
  if (std::adjacent_find(edges.begin(), edges.end()) != edges.end()) return false;
  return std::all_of(edges.begin(), edges.end(), [&](const DirectedEdge& e) {
    return std::binary_search(edges.begin(), edges.end(), DirectedEdge{e[0], e[2], e[1]});
  });
}

}  // namespace sunder::crack::detail
