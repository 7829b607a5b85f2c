#pragma once
/// Polygons become triangles that are small where detail is wanted.
#include <vector>

#include "core/progress.h"
#include "crack/detail/index_table.h"
#include "geometry/cut.h"
#include "geometry/mesh.h"

namespace sunder::crack::detail {

/// Triangles of a complex; those of one source face are contiguous, in the order of the faces.
struct FineMesh {
  std::vector<Vec3> vertices;
  std::vector<geometry::Triangle> faces;
  std::vector<int> source;  ///< per triangle: the face of the complex
};

/// How long edges may be: `edge` in the box, growing with the distance from it.
struct Sizing {
  Box box;
  double edge = 0;    ///< [m]
  double growth = 1;  ///< per distance from the box

  bool too_long(const Vec3& a, const Vec3& b) const;
};

/// Fans around the mean of the corners: it lies inside a convex polygon, and no fan triangle is flat where three
/// corners lie on a line. Triangles stay.
FineMesh triangulated(const geometry::RegionBoundary& boundary);

/// Halves all edges that are too long until none is. Whether an edge is split depends on its ends alone, so all faces
/// around it agree and every edge keeps its number of faces. Between two rounds of it, diagonals within source faces
/// are flipped to Delaunay ones. Throws ErrorKind::usage above `most` triangles.
void refine(FineMesh& mesh, const Sizing& sizing, int most, Progress& progress);

/// Lawson flips of the edges inside every source face, which is planar: the border of a face stays as it is.
void flip_to_delaunay(FineMesh& mesh);

}  // namespace sunder::crack::detail
