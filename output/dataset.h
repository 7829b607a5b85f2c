#pragma once
/// Pieces as arrays, for programs that learn from them.
#include <cstdint>
#include <string>

#include "geometry/mesh.h"
#include "output/sequence.h"

namespace sunder::output {

/// The pieces of a frame as NPZ (docs/batch.md names every array): their meshes one after another, each in its own
/// frame with the centre of mass as origin, labels for each face, masses and areas, and the transforms that put them
/// together again. With `points` above 0 that many points drawn evenly from all surfaces by `seed`, each with the
/// number of its piece. Errors: those of Npz.
std::string pieces_npz(const Sequence& sequence, std::size_t frame, int points, std::uint64_t seed);

/// The mesh that broke, as NPZ: `vertices` and `faces`.
std::string mesh_npz(const geometry::TriangleMesh& mesh);

}  // namespace sunder::output
