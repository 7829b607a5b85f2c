#include "geometry/mesh.h"

#include <utility>

namespace sunder::geometry {

Box bounds(const TriangleMesh& mesh) {
  Box box;
  for (const Vec3& vertex : mesh.vertices) box.extend(vertex);
  return box;
}

TriangleMesh transformed(const TriangleMesh& mesh, const Mat3& linear, const Vec3& offset) {
  TriangleMesh result = mesh;
  for (Vec3& vertex : result.vertices) vertex = (linear * vertex + offset).eval();
  if (linear.determinant() < 0) {
    for (Triangle& face : result.faces) std::swap(face[1], face[2]);
  }
  return result;
}

}  // namespace sunder::geometry
