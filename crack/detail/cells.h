#pragma once
/// The Voronoi cells of labelled sites in a box, as far as cracks need them: the faces between pieces and on the walls.
#include <optional>
#include <vector>

#include "core/types.h"

namespace sunder::crack::detail {

/// A point that owns a Voronoi cell.
struct Site {
  Vec3 position;
  int piece = 0;
  int lattice = 0;         ///< its position on the lattice: no other site has it
  int node = 0;            ///< of the body: itself, or the one that it continues beyond the surface
  bool is_border = false;  ///< beside damage or beside another piece
};

/// The face that two cells share, or a cell shares with a wall of the box.
struct CellFace {
  int site = 0;
  int neighbour = 0;      ///< a higher site, or -1 to -6: a wall
  std::vector<int> loop;  ///< vertices, counter-clockwise seen from the neighbour
};

struct CellFaces {
  std::vector<Vec3> vertices;
  std::vector<CellFace> faces;  ///< between sites of different pieces and on walls, by (site, neighbour)
  std::vector<CellFace> inner;  ///< between border sites of one piece that are farther apart than asked
};

struct CellRequest {
  Box box;          ///< the cells fill it
  double unit = 1;  ///< typical distance between sites [m]: Voro++ has absolute tolerances and gets lengths in this
  double shortest_edge = 0;   ///< no edge between pieces may be shorter [m]
  double inner_distance = 0;  ///< inner faces are wanted between sites farther apart than this [m]
  bool pieces = true;         ///< false: inner faces only
};

/// Cells by Voro++ (Rycroft 2009), on all threads; the result does not depend on how many there are. Every cell has its
/// own rounded copy of a vertex; what makes them one is the set of the four cells or walls that meet there, and its
/// position is the one that the lowest site gives it. Nothing where that fails: more than four meet, two cells disagree
/// about the face between them, an edge is too short.
std::optional<CellFaces> cell_faces(const std::vector<Site>& sites, const CellRequest& request);

}  // namespace sunder::crack::detail
