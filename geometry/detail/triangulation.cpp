#include "geometry/detail/triangulation.h"

#include <algorithm>

#include "core/error.h"
#include "geometry/detail/planar_mesh.h"
#include "geometry/detail/predicates.h"

namespace sunder::geometry::detail {
namespace {

// The parts of a valid triangulation overlap after rounding only if one of them is turned or flattened.
void require_sound(const Points& points, const Triangle& corners, const std::vector<Triangle>& faces) {
  const int axis = dominant_axis(points, corners), x = (axis + 1) % 3, y = (axis + 2) % 3;
  const auto turn = [&](const Triangle& face) {
    const Vec3 &a = points[face[0]], &b = points[face[1]], &c = points[face[2]];
    return planar_orientation(a[x], a[y], b[x], b[y], c[x], c[y]);
  };
  const int wanted = turn(corners);
  for (const Triangle& face : faces) {
    if (turn(face) != wanted) throw Error(ErrorKind::mesh, "rounding turns a part of a face");
  }
}

bool is_plain_cut(const Division& division) {
  if (division.barriers.size() != 1 || !division.inside.empty()) return false;
  return std::all_of(division.on_edge.begin(), division.on_edge.end(), [](const auto& ids) { return ids.size() < 2; });
}

// One segment from edge to edge: by far the most common case. It parts the tip at corner s from a quad.
Patch plain_cut(const Points& points, const Division& division) {
  int s = 0;
  while (!division.on_edge[(s + 1) % 3].empty()) ++s;
  const int tip = division.corners[s], b = division.corners[(s + 1) % 3], c = division.corners[(s + 2) % 3];
  const int p = division.on_edge[s][0], q = division.on_edge[(s + 2) % 3][0];
  Patch patch;
  patch.faces.push_back({tip, p, q});
  if (worth_flipping(points[p], points[c], points[q], points[b])) {
    patch.faces.insert(patch.faces.end(), {{p, b, q}, {b, c, q}});
  } else {
    patch.faces.insert(patch.faces.end(), {{p, b, c}, {p, c, q}});
  }
  patch.cell = {0, 1, 1};
  patch.cells = 2;
  for (int k = 0; k < 3; ++k) {
    patch.first_rim[k] = static_cast<int>(patch.rim.size());
    if (k == s) patch.rim.insert(patch.rim.end(), {0, 1});
    if (k == (s + 1) % 3) patch.rim.push_back(1);
    if (k == (s + 2) % 3) patch.rim.insert(patch.rim.end(), {1, 0});
  }
  const Barrier& barrier = division.barriers[0];
  patch.barriers.push_back(barrier.start == p ? BarrierCells{barrier.number, 0, 1}
                                              : BarrierCells{barrier.number, 1, 0});
  return patch;
}

// Vertices of the mesh by point: corners, then edges, then inside, as they were added.
class VertexOf {
 public:
  explicit VertexOf(const PlanarMesh& mesh, int count) {
    for (int vertex = 0; vertex < count; ++vertex) vertices_.push_back({mesh.id(vertex), vertex});
    std::sort(vertices_.begin(), vertices_.end());
  }
  int operator()(int id) const {
    return std::lower_bound(vertices_.begin(), vertices_.end(), std::array<int, 2>{id, -1})->at(1);
  }

 private:
  std::vector<std::array<int, 2>> vertices_;
};

PlanarMesh triangulate(const Points& points, const Division& division) {
  PlanarMesh mesh(points, division.corners);
  int count = 3 + static_cast<int>(division.inside.size());
  for (int k = 0; k < 3; ++k) {
    mesh.add_on_edge(k, division.on_edge[k]);
    count += static_cast<int>(division.on_edge[k].size());
  }
  for (const int id : division.inside) mesh.add_inside(id);
  const VertexOf vertex_of(mesh, count);
  for (std::size_t i = 0; i < division.barriers.size(); ++i) {
    const Barrier& barrier = division.barriers[i];
    mesh.add_barrier(vertex_of(barrier.start), vertex_of(barrier.end), static_cast<int>(i));
  }
  return mesh;
}

void flood_cells(const PlanarMesh& mesh, Patch& patch) {
  const auto& cells = mesh.cells();
  patch.cell.assign(cells.size(), -1);
  std::vector<int> open;
  for (std::size_t start = 0; start < cells.size(); ++start) {
    if (patch.cell[start] >= 0) continue;
    patch.cell[start] = patch.cells;
    open.push_back(static_cast<int>(start));
    while (!open.empty()) {
      const PlanarMesh::Cell& cell = cells[open.back()];
      open.pop_back();
      for (int k = 0; k < 3; ++k) {
        const int other = cell.across[k];
        if (other < 0 || cell.barrier[k] >= 0 || patch.cell[other] >= 0) continue;
        patch.cell[other] = patch.cells;
        open.push_back(other);
      }
    }
    ++patch.cells;
  }
}

void mark_rim(const PlanarMesh& mesh, const Division& division, Patch& patch) {
  std::array<int, 3> first_vertex{};
  int vertex = 3, slot = 0;
  for (int k = 0; k < 3; ++k) {
    const int count = static_cast<int>(division.on_edge[k].size());
    first_vertex[k] = vertex;
    patch.first_rim[k] = slot;
    vertex += count;
    slot += count + 1;
  }
  patch.rim.assign(slot, -1);
  for (std::size_t i = 0; i < mesh.cells().size(); ++i) {
    const PlanarMesh::Cell& cell = mesh.cells()[i];
    for (int k = 0; k < 3; ++k) {
      if (cell.across[k] >= 0) continue;
      const int start = cell.vertex[k], edge = mesh.common_edge(start, cell.vertex[(k + 1) % 3]);
      const int place = start < 3 ? 0 : start - first_vertex[edge] + 1;
      patch.rim[patch.first_rim[edge] + place] = patch.cell[i];
    }
  }
}

void mark_barriers(const PlanarMesh& mesh, const Division& division, Patch& patch) {
  for (const Barrier& barrier : division.barriers) patch.barriers.push_back({barrier.number, -1, -1});
  for (std::size_t i = 0; i < mesh.cells().size(); ++i) {
    const PlanarMesh::Cell& cell = mesh.cells()[i];
    for (int k = 0; k < 3; ++k) {
      const int number = cell.barrier[k];
      if (number < 0) continue;
      const bool left = mesh.id(cell.vertex[k]) == division.barriers[number].start;
      (left ? patch.barriers[number].left : patch.barriers[number].right) = patch.cell[i];
    }
  }
}

}  // namespace

Patch divide(const Points& points, const Division& division) {
  Patch patch;
  if (is_plain_cut(division)) {
    patch = plain_cut(points, division);
  } else {
    const PlanarMesh mesh = triangulate(points, division);
    for (const PlanarMesh::Cell& cell : mesh.cells()) {
      patch.faces.push_back({mesh.id(cell.vertex[0]), mesh.id(cell.vertex[1]), mesh.id(cell.vertex[2])});
    }
    flood_cells(mesh, patch);
    mark_rim(mesh, division, patch);
    mark_barriers(mesh, division, patch);
  }
  require_sound(points, division.corners, patch.faces);
  return patch;
}

}  // namespace sunder::geometry::detail
