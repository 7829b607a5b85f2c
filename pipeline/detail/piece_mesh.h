#pragma once
/// From a mesh to the piece that has it.
#include "pipeline/handover.h"
#include "pipeline/sequence.h"

namespace sunder::pipeline::detail {

/// Moves `mesh` so that its centre of mass is the origin, fills in the piece's volume, area, mass and whether it is
/// closed, and returns the mass properties with the centre that the mesh had.
RigidPart centred(geometry::TriangleMesh& mesh, double density, Piece& piece);

}  // namespace sunder::pipeline::detail
