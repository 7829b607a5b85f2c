#pragma once
/// A body and cracks divided along the segments where they cross.
#include <array>
#include <vector>

#include "geometry/detail/crossings.h"
#include "geometry/detail/triangulation.h"

namespace sunder::geometry::detail {

/// One of the two surfaces with its faces divided. Cells are numbered through: those of face 0, of face 1, ...
struct Divided {
  Surface surface;
  std::vector<int> patch_of;  // per face, -1: it is whole
  std::vector<Patch> patches;
  std::vector<int> first_cell;  // per face, and one more
  Lists on_edge;                // nodes along every edge, from its lower vertex to its higher one

  int face_count() const { return static_cast<int>(surface.faces.size()); }
  int cell_count() const { return first_cell.back(); }
  int slot_count(int edge) const { return on_edge.size(edge) + 1; }

  /// The cell of a face at part `slot` of one of its edges, counted from the edge's lower vertex.
  int cell_at(const HalfEdge& side, int slot) const;
};

struct Arrangement {
  Points points;  // of the body, of the cracks, nodes
  Divided body, cracks;
  std::vector<Segment> segments;
  // Per segment the cells on its left and right, looking from start to end.
  std::vector<std::array<int, 2>> body_cells, crack_cells;
  int first_crack_point = 0;
  int first_crack_edge_node = 0;  // nodes from here on lie on edges of cracks, those before on edges of the body
};

/// Face indices refer to `inputs`. `tree` holds the faces of the body. The result does not depend on the number of
/// threads. Errors: ErrorKind::mesh when the surfaces are not in general position or rounding breaks something.
Arrangement arrange(const std::vector<Vec3>& inputs, int first_crack_point, const Surface& body, const BoxTree& tree,
                    const Surface& cracks);

/// Calls visit(vertices, cell) for all parts of a face.
template <typename Visit>
void for_each_part(const Divided& divided, int face, const Visit& visit) {
  const int first = divided.first_cell[face];
  if (divided.patch_of[face] < 0) return visit(divided.surface.faces[face], first);
  const Patch& patch = divided.patches[divided.patch_of[face]];
  for (std::size_t i = 0; i < patch.faces.size(); ++i) visit(patch.faces[i], first + patch.cell[i]);
}

}  // namespace sunder::geometry::detail
