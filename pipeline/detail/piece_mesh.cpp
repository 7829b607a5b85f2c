#include "pipeline/detail/piece_mesh.h"

#include <numeric>

#include "geometry/mass_properties.h"

namespace sunder::pipeline::detail {
namespace {

double inside_area(const output::Piece& piece) {
  double area = 0;
  for (std::size_t f = 0; f < piece.mesh.faces.size(); ++f)
    if (piece.inside(f)) area += geometry::face_area(piece.mesh, f);
  return area;
}

}  // namespace

output::Piece whole_piece(const std::string& name, const std::string& material, geometry::TriangleMesh mesh,
                          geometry::SurfaceAttributes surface) {
  output::Piece piece;
  piece.name = piece.body = name;
  piece.material = material;
  piece.source_face.resize(mesh.faces.size());
  std::iota(piece.source_face.begin(), piece.source_face.end(), 0);
  if (surface.material.empty()) {
    surface.material.assign(mesh.faces.size(), 0);
    surface.material_names = {output::outside_material(material)};
  }
  piece.mesh = std::move(mesh);
  piece.surface = std::move(surface);
  return piece;
}

output::Piece fragment_piece(const output::Piece& parent, const geometry::Fragment& fragment, const Cracked& cracked) {
  output::Piece piece;
  piece.body = parent.body;
  piece.parent = parent.id;
  piece.generation = parent.generation + 1;
  piece.material = parent.material;
  piece.mesh = fragment.mesh;
  for (const int source : fragment.source_face)
    piece.source_face.push_back(source < 0 ? -1 : parent.source_face[static_cast<std::size_t>(source)]);
  geometry::InsideSettings inside;
  inside.material = output::inside_material(parent.material);
  inside.uv = true;
  inside.damage_time = cracked.damage_time;
  piece.surface = geometry::carry(parent.mesh, parent.surface, fragment, cracked.boundary, inside);
  return piece;
}

RigidPart measured(output::Piece& piece, double density) {
  const geometry::MassProperties m = geometry::mass_properties(piece.mesh);
  piece.volume = m.volume;
  piece.closed = geometry::is_closed_two_manifold(piece.mesh);
  piece.area = m.area;
  piece.inside_area = inside_area(piece);
  piece.mass = density * m.volume;
  return {piece.mass, m.centroid, density * m.inertia};
}

RigidPart centred(output::Piece& piece, double density) {
  const RigidPart part = measured(piece, density);
  piece.mesh = geometry::transformed(piece.mesh, Mat3::Identity(), -part.centre);
  return part;
}

}  // namespace sunder::pipeline::detail
