#include "geometry/detail/pinches.h"

#include <algorithm>
#include <set>
#include <utility>

namespace sunder::geometry::detail {
namespace {

/// A corner of a face at a vertex, between the edges to `next` and to `last`.
struct Corner {
  int vertex, next, last;
  int face, k;
};

using Corners = std::vector<Corner>;
using EdgeSet = std::set<std::pair<int, int>>;  // lower and higher vertex

std::pair<int, int> edge(int a, int b) { return std::minmax(a, b); }

Corners suspect_corners(const Fragment& fragment, const std::vector<bool>& suspect) {
  Corners corners;
  for (int face = 0; face < static_cast<int>(fragment.mesh.faces.size()); ++face) {
    const Triangle& f = fragment.mesh.faces[face];
    for (int k = 0; k < 3; ++k) {
      if (suspect[fragment.vertex_id[f[k]]]) corners.push_back({f[k], f[(k + 1) % 3], f[(k + 2) % 3], face, k});
    }
  }
  std::stable_sort(corners.begin(), corners.end(),
                   [](const Corner& a, const Corner& b) { return a.vertex < b.vertex; });
  return corners;
}

// Calls visit(begin, end) for the corners of every vertex.
template <typename Visit>
void for_each_vertex(const Corners& corners, const Visit& visit) {
  for (auto begin = corners.begin(), end = begin; begin != corners.end(); begin = end) {
    while (end != corners.end() && end->vertex == begin->vertex) ++end;
    visit(begin, end);
  }
}

// Edges with more than two faces, by the vertices that the faces have in `mesh`, named by those that the corners have.
EdgeSet crowded_edges(const Corners& corners, const TriangleMesh& mesh) {
  EdgeSet result;
  for_each_vertex(corners, [&](auto begin, auto end) {
    std::vector<std::pair<std::pair<int, int>, int>> directed;
    for (auto corner = begin; corner != end; ++corner) {
      const Triangle& face = mesh.faces[corner->face];
      directed.push_back({{face[corner->k], face[(corner->k + 1) % 3]}, corner->next});
    }
    std::sort(directed.begin(), directed.end());
    for (std::size_t i = 1; i < directed.size(); ++i) {
      if (directed[i].first == directed[i - 1].first) result.insert(edge(begin->vertex, directed[i].second));
    }
  });
  return result;
}

}  // namespace

// A crack crosses the body's faces and edges plainly, so only at its own vertices and along edges where a region has
// several wedges can a region touch itself.
PinchFinder::PinchFinder(const Arrangement& arrangement, const Wedges& wedges)
    : suspect_(arrangement.points.size(), false), wedges_(wedges) {
  for (int id = arrangement.first_crack_point; id < arrangement.points.input_count(); ++id) suspect_[id] = true;
  const Divided& cracks = arrangement.cracks;
  for (int edge = 0; edge < cracks.surface.edges.count(); ++edge) {
    if (!wedges.repeats_region(edge)) continue;
    for (const int* id = cracks.on_edge.begin(edge); id != cracks.on_edge.end(edge); ++id) suspect_[*id] = true;
  }
}

bool PinchFinder::share_wedge(const CrackSide& a, const CrackSide& b) const {
  for (int k = 0; k < 3; ++k) {
    if (a.triangle >= 0 && b.triangle >= 0 && wedges_.across(a, k) == b) return true;
  }
  return false;
}

void PinchFinder::split(Fragment& fragment, const std::vector<CrackSide>& sides) const {
  constexpr int kRounds = 8;
  const Corners corners = suspect_corners(fragment, suspect_);
  // Normally the two faces of a wedge of material follow each other. Where an edge of contact ends at both vertices
  // without parting their fans, the faces across from each other do: it is then the space beside that has the fans.
  EdgeSet across;
  const Fragment whole = crowded_edges(corners, fragment.mesh).empty() ? Fragment{} : fragment;
  for (int round = 0; round < kRounds; ++round) {
    std::vector<bool> seen(corners.size(), false);
    for_each_vertex(corners, [&](auto begin, auto end) {
      const auto after = [&](const Corner& corner) {
        auto found = end;
        for (auto other = begin; other != end; ++other) {
          if (other->next != corner.last) continue;
          const bool wedge = share_wedge(sides[corner.face], sides[other->face]);
          if (found == end || wedge != across.contains(edge(corner.vertex, corner.last))) found = other;
        }
        return found;
      };
      int copy = begin->vertex;
      for (auto start = begin; start != end; ++start) {
        if (seen[start - corners.begin()]) continue;
        if (copy < 0) {
          copy = static_cast<int>(fragment.vertex_id.size());
          fragment.vertex_id.push_back(fragment.vertex_id[start->vertex]);
        }
        for (auto corner = start; corner != end && !seen[corner - corners.begin()]; corner = after(*corner)) {
          seen[corner - corners.begin()] = true;
          fragment.mesh.faces[corner->face][corner->k] = copy;
        }
        copy = -1;
      }
    });
    const EdgeSet crowded = whole.mesh.faces.empty() ? EdgeSet{} : crowded_edges(corners, fragment.mesh);
    if (crowded.empty()) return;
    across.insert(crowded.begin(), crowded.end());
    if (round + 1 < kRounds) fragment = whole;
  }
}

}  // namespace sunder::geometry::detail
