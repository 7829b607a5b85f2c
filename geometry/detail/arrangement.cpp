#include "geometry/detail/arrangement.h"

#include <tbb/parallel_for.h>

#include "core/error.h"

namespace sunder::geometry::detail {
namespace {

void sort_along_edges(const Points& points, const Edges& edges, Lists& on_edge) {
  tbb::parallel_for(tbb::blocked_range<int>(0, edges.count(), 1024), [&](const tbb::blocked_range<int>& range) {
    for (int edge = range.begin(); edge != range.end(); ++edge) {
      if (on_edge.size(edge) < 2) continue;
      const Vec3 along = points[edges.ends[edge][1]] - points[edges.ends[edge][0]];
      int axis = 0;
      along.cwiseAbs().maxCoeff(&axis);
      const int direction = along[axis] > 0 ? 1 : -1;
      const auto before = [&](int a, int b) { return a != b && direction * points.compare(axis, a, b) < 0; };
      const auto begin = on_edge.items.begin() + on_edge.first[edge],
                 end = on_edge.items.begin() + on_edge.first[edge + 1];
      std::sort(begin, end, before);
      const auto coincide = [&](int a, int b) { return points.compare(axis, a, b) == 0; };
      if (std::adjacent_find(begin, end, coincide) != end) throw Error(ErrorKind::mesh, "two cracks meet on an edge");
    }
  });
}

Division division_of(const Divided& divided, int face, const Lists& on_face, const Arrangement& arrangement,
                     bool is_body) {
  Division division;
  division.corners = divided.surface.faces[face];
  for (int k = 0; k < 3; ++k) {
    const int edge = divided.surface.edges.of_face[face][k];
    std::vector<int>& along = division.on_edge[k];
    along.assign(divided.on_edge.begin(edge), divided.on_edge.end(edge));
    if (division.corners[k] > division.corners[(k + 1) % 3]) std::reverse(along.begin(), along.end());
  }
  for (const int* i = on_face.begin(face); i != on_face.end(face); ++i) {
    const Segment& segment = arrangement.segments[*i];
    division.barriers.push_back({segment.start, segment.end, *i});
    for (const int node : {segment.start, segment.end}) {
      const bool on_body_edge = node < arrangement.first_crack_edge_node;
      if (on_body_edge != is_body) division.inside.push_back(node);
    }
  }
  std::sort(division.inside.begin(), division.inside.end());
  division.inside.erase(std::unique(division.inside.begin(), division.inside.end()), division.inside.end());
  return division;
}

void divide_all(const Lists& on_face, const Arrangement& arrangement, bool is_body, Divided& divided) {
  std::vector<int> touched;
  divided.patch_of.assign(divided.face_count(), -1);
  for (int face = 0; face < divided.face_count(); ++face) {
    if (on_face.size(face) == 0) continue;
    divided.patch_of[face] = static_cast<int>(touched.size());
    touched.push_back(face);
  }
  divided.patches.resize(touched.size());
  tbb::parallel_for(std::size_t{0}, touched.size(), [&](std::size_t i) {
    divided.patches[i] = divide(arrangement.points, division_of(divided, touched[i], on_face, arrangement, is_body));
  });
  divided.first_cell.assign(1, 0);
  for (const int patch : divided.patch_of) {
    divided.first_cell.push_back(divided.first_cell.back() + (patch < 0 ? 1 : divided.patches[patch].cells));
  }
}

std::vector<std::array<int, 2>> cells_of_segments(const Divided& divided, std::size_t segments) {
  std::vector<std::array<int, 2>> cells(segments, {-1, -1});
  for (int face = 0; face < divided.face_count(); ++face) {
    if (divided.patch_of[face] < 0) continue;
    const int first = divided.first_cell[face];
    for (const BarrierCells& barrier : divided.patches[divided.patch_of[face]].barriers) {
      cells[barrier.number] = {first + barrier.left, first + barrier.right};
    }
  }
  return cells;
}

}  // namespace

int Divided::cell_at(const HalfEdge& side, int slot) const {
  const int first = first_cell[side.face], patch = patch_of[side.face];
  if (patch < 0) return first;
  const int count = slot_count(surface.edges.of_face[side.face][side.corner]);
  const Patch& divided = patches[patch];
  return first + divided.rim[divided.first_rim[side.corner] + (side.forward ? slot : count - 1 - slot)];
}

Arrangement arrange(const std::vector<Vec3>& inputs, int first_crack_point, const Surface& body, const BoxTree& tree,
                    const Surface& cracks) {
  Crossings crossings = find_crossings(inputs, body, tree, cracks);
  const int first_node = static_cast<int>(inputs.size());
  Arrangement result{.points = Points(inputs, std::move(crossings.nodes)),
                     .body = {body, {}, {}, {}, std::move(crossings.on_body_edge)},
                     .cracks = {cracks, {}, {}, {}, std::move(crossings.on_crack_edge)},
                     .segments = std::move(crossings.segments),
                     .body_cells = {},
                     .crack_cells = {},
                     .first_crack_point = first_crack_point};
  result.first_crack_edge_node = first_node + static_cast<int>(result.body.on_edge.items.size());
  sort_along_edges(result.points, body.edges, result.body.on_edge);
  sort_along_edges(result.points, cracks.edges, result.cracks.on_edge);
  divide_all(crossings.on_face, result, true, result.body);
  divide_all(crossings.on_triangle, result, false, result.cracks);
  result.body_cells = cells_of_segments(result.body, result.segments.size());
  result.crack_cells = cells_of_segments(result.cracks, result.segments.size());
  return result;
}

}  // namespace sunder::geometry::detail
