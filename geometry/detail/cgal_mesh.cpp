#include "geometry/detail/cgal_mesh.h"

#include <string>

#include "core/error.h"

namespace sunder::geometry::detail {

SurfaceMesh to_cgal(const TriangleMesh& mesh) {
  SurfaceMesh result;
  result.reserve(mesh.vertices.size(), mesh.faces.size() * 3 / 2, mesh.faces.size());
  for (const Vec3& vertex : mesh.vertices) result.add_vertex(to_point(vertex));
  using Vertex = SurfaceMesh::Vertex_index;
  for (std::size_t i = 0; i < mesh.faces.size(); ++i) {
    const auto& [a, b, c] = mesh.faces[i];
    if (result.add_face(Vertex(a), Vertex(b), Vertex(c)) == SurfaceMesh::null_face()) {
      throw Error(ErrorKind::mesh, "face " + std::to_string(i) + " does not fit an oriented manifold surface");
    }
  }
  return result;
}

TriangleMesh from_cgal(const SurfaceMesh& mesh) {
  TriangleMesh result;
  std::vector<int> index(mesh.num_vertices(), -1);
  for (const auto vertex : mesh.vertices()) {
    if (mesh.is_isolated(vertex)) continue;
    index[vertex] = static_cast<int>(result.vertices.size());
    result.vertices.push_back(to_vec3(mesh.point(vertex)));
  }
  for (const auto face : mesh.faces()) {
    const auto edge = mesh.halfedge(face);
    result.faces.push_back({index[mesh.source(edge)], index[mesh.target(edge)], index[mesh.target(mesh.next(edge))]});
  }
  return result;
}

}  // namespace sunder::geometry::detail
