#pragma once
/// The Boolean of the cut: the part of one body inside one region after the other.
#include <array>
#include <vector>

#include <CGAL/AABB_face_graph_triangle_primitive.h>
#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/Side_of_triangle_mesh.h>

#include "geometry/detail/cgal_mesh.h"
#include "geometry/detail/shells.h"

namespace sunder::geometry::detail {

/// A body prepared for being cut many times.
class BodyCut {
 public:
  /// The body must be a closed, oriented manifold that bounds a volume, without degenerate faces or coincident
  /// vertices.
  BodyCut(const TriangleMesh& body, const SurfaceMesh& surface);
  BodyCut(const BodyCut&) = delete;

  /// The surface of the intersection, made by corefining only the faces that meet. Source -1: on the region's surface.
  /// Exact predicates decide everything but the side of patches without an input vertex off the other surface: there it
  /// is the rounded centroid of the largest face. Errors: ErrorKind::mesh when a patch lies on the other surface
  /// (coplanar faces); CGAL exceptions.
  Piece inside(SurfaceMesh region) const;

  /// The same from CGAL's Boolean of the two whole surfaces: slow, but it knows coplanar faces.
  /// Errors: ErrorKind::mesh when the result is not manifold; CGAL exceptions.
  Piece inside_whole(SurfaceMesh region) const;

 private:
  using Primitive = CGAL::AABB_face_graph_triangle_primitive<SurfaceMesh>;
  using Tree = CGAL::AABB_tree<CGAL::AABB_traits<Kernel, Primitive>>;
  struct Patch;

  /// The faces that meet the region's surface, and all faces around a vertex where they form more than one fan: there
  /// the patch would touch itself, which corefinement takes for a self-intersection.
  std::vector<int> faces_near(const SurfaceMesh& region) const;
  Patch patch_of(const std::vector<int>& near) const;
  std::vector<std::vector<int>> untouched(const std::vector<int>& near) const;

  const TriangleMesh& body_;
  const SurfaceMesh& surface_;
  std::vector<std::array<int, 3>> neighbours_;
  Tree tree_;
  CGAL::Side_of_triangle_mesh<SurfaceMesh, Kernel> side_;
};

}  // namespace sunder::geometry::detail
