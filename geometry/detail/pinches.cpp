#include "geometry/detail/pinches.h"

#include <algorithm>

namespace sunder::geometry::detail {
namespace {

/// A corner of a face at a vertex, between the edges to `next` and to `last`.
struct Corner {
  int vertex, next, last;
  int face, k;
  bool seen = false;
};

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

bool PinchFinder::follows(const CrackSide& a, const CrackSide& b) const {
  for (int k = 0; k < 3; ++k) {
    if (a.triangle >= 0 && b.triangle >= 0 && wedges_.across(a, k) == b) return true;
  }
  return false;
}

void PinchFinder::split(Fragment& fragment, const std::vector<CrackSide>& sides) const {
  std::vector<Corner> corners;
  for (int face = 0; face < static_cast<int>(fragment.mesh.faces.size()); ++face) {
    const Triangle& f = fragment.mesh.faces[face];
    for (int k = 0; k < 3; ++k) {
      if (suspect_[fragment.vertex_id[f[k]]]) corners.push_back({f[k], f[(k + 1) % 3], f[(k + 2) % 3], face, k});
    }
  }
  std::stable_sort(corners.begin(), corners.end(),
                   [](const Corner& a, const Corner& b) { return a.vertex < b.vertex; });
  for (auto begin = corners.begin(), end = begin; begin != corners.end(); begin = end) {
    while (end != corners.end() && end->vertex == begin->vertex) ++end;
    // Two faces in a row around the vertex share the edge to `last` of one and `next` of the other. If more than two
    // meet there, the wedges of the crack tell which belong together.
    const auto after = [&](const Corner& corner) {
      auto found = end;
      for (auto other = begin; other != end; ++other) {
        if (other->next != corner.last) continue;
        if (found == end || follows(sides[corner.face], sides[other->face])) found = other;
      }
      return found;
    };
    bool first = true;
    for (auto start = begin; start != end; ++start) {
      if (start->seen) continue;
      const int copy = first ? start->vertex : static_cast<int>(fragment.vertex_id.size());
      if (!first) fragment.vertex_id.push_back(fragment.vertex_id[start->vertex]);
      first = false;
      for (auto corner = start; corner != end && !corner->seen; corner = after(*corner)) {
        corner->seen = true;
        fragment.mesh.faces[corner->face][corner->k] = copy;
      }
    }
  }
}

}  // namespace sunder::geometry::detail
