#include "pipeline/detail/piece_mesh.h"

#include "geometry/mass_properties.h"

namespace sunder::pipeline::detail {

RigidPart centred(geometry::TriangleMesh& mesh, double density, Piece& piece) {
  const auto m = geometry::mass_properties(mesh);
  mesh = geometry::transformed(mesh, Mat3::Identity(), -m.centroid);
  piece.volume = m.volume;
  piece.closed = geometry::is_closed_two_manifold(mesh);
  piece.area = m.area;
  piece.mass = density * m.volume;
  return {piece.mass, m.centroid, density * m.inertia};
}

}  // namespace sunder::pipeline::detail
