#pragma once
/// A short sequence for the writers: a bar that breaks into two tetrahedra at the third of five frames.
#include "output/sequence.h"

namespace sunder::output {

inline Piece example_piece(int id, const std::string& name, int parent) {
  Piece piece;
  piece.id = id;
  piece.name = name;
  piece.body = "bar";
  piece.parent = parent;
  piece.generation = parent < 0 ? 0 : 1;
  piece.mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 0.1234567891}};
  piece.mesh.faces = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  piece.source_face = {parent >= 0 ? -1 : 0, 1, 2, 3};
  piece.surface.material_names = {"glass_outside", "glass_inside"};
  piece.surface.material = {parent >= 0 ? 1 : 0, 0, 0, 0};
  piece.volume = 0.02;
  piece.mass = 50;
  piece.material = "glass";
  return piece;
}

/// The same tetrahedron as a fragment that carries everything: texture and normals of the body, a crack face with
/// damage times.
inline Piece attributed_piece(int id, const std::string& name, int parent) {
  Piece piece = example_piece(id, name, parent);
  geometry::SurfaceAttributes& surface = piece.surface;
  for (std::size_t f = 0; f < piece.mesh.faces.size(); ++f) {
    const auto& [a, b, c] = piece.mesh.faces[f];
    const auto at = [&](int v) -> const Vec3& { return piece.mesh.vertices[static_cast<std::size_t>(v)]; };
    const Vec3 normal = (at(b) - at(a)).cross(at(c) - at(a)).normalized();
    surface.normal.push_back({normal, normal, normal});
    surface.uv.push_back({geometry::Uv(0, 0), geometry::Uv(0.75, 0.1), geometry::Uv(0.5, 1)});
    surface.colour.push_back(
        {geometry::Colour(1, 0.5, 0, 1), geometry::Colour(0, 0, 1, 1), geometry::Colour(1, 1, 1, 0.25)});
    const double time = piece.inside(f) ? 1e-4 : -1;
    surface.damage_time.push_back({time, time, piece.inside(f) ? 2e-4 : -1});
  }
  return piece;
}

inline Sequence example_sequence() {
  Sequence sequence;
  sequence.name = "example";
  sequence.frame_rate = 10;
  sequence.start_frame = 8;
  sequence.pieces = {example_piece(0, "bar", -1), example_piece(1, "bar_0001", 0), example_piece(2, "bar_0002", 0)};
  sequence.pieces[0].death_time = 0.2;
  sequence.pieces[1].birth_time = sequence.pieces[2].birth_time = 0.2;
  for (int i = 0; i < 5; ++i) {
    const double time = 0.1 * i;
    const Pose pose{Vec3(0, 1 - time, 0), Quat(Eigen::AngleAxisd(2 * time, Vec3::UnitZ()))};
    // Every second quaternion has the other sign: the same rotation.
    const Pose flipped{Vec3(0, 1, 0), i % 2 ? pose.orientation : Quat(-pose.orientation.coeffs())};
    if (i < 2) sequence.frames.push_back({time, {{0, pose, {}}}});
    if (i >= 2) sequence.frames.push_back({time, {{1, pose, {}}, {2, flipped, {}}}});
  }
  return sequence;
}

/// The example with pieces that carry everything.
inline Sequence attributed_sequence() {
  Sequence sequence = example_sequence();
  for (Piece& piece : sequence.pieces) {
    Piece attributed = attributed_piece(piece.id, piece.name, piece.parent);
    attributed.birth_time = piece.birth_time;
    attributed.death_time = piece.death_time;
    piece = std::move(attributed);
  }
  return sequence;
}

}  // namespace sunder::output
