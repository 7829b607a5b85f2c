#pragma once
/// From a mesh to the piece that has it.
#include "output/sequence.h"
#include "pipeline/cracking.h"
#include "pipeline/handover.h"

namespace sunder::pipeline::detail {

/// A piece of the substance `material` that nothing has broken yet. Where `surface` names no materials, that of the
/// substance's outside is everywhere.
output::Piece whole_piece(const std::string& name, const std::string& material, geometry::TriangleMesh mesh,
                          geometry::SurfaceAttributes surface);

/// The piece that a cut made of its parent; id and name are left open.
output::Piece fragment_piece(const output::Piece& parent, const geometry::Fragment& fragment, const Cracked& cracked);

/// Fills in volume, areas, mass and whether it is closed, and returns the mass properties.
RigidPart measured(output::Piece& piece, double density);

/// The same, and moves the piece's mesh so that its centre of mass is the origin; returned is the centre that it had.
RigidPart centred(output::Piece& piece, double density);

}  // namespace sunder::pipeline::detail
