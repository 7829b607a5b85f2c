#pragma once
/// Faces with attributes per corner as a renderer wants them: vertices with everything they carry, and indices.
#include <array>
#include <cstdint>
#include <vector>

#include "output/sequence.h"

namespace sunder::output::detail {

/// Lists other than `vertex` are empty where the faces carry nothing of the kind, or as long as it.
struct VertexArrays {
  std::vector<int> vertex;  ///< index in the piece's mesh
  std::vector<std::array<float, 2>> uv;
  std::vector<std::array<float, 3>> normal;
  std::vector<std::array<float, 4>> colour;
  std::vector<float> damage_time;     ///< [s], -1: unknown
  std::vector<std::uint32_t> corner;  ///< three per face: indices into the lists above
};

/// Whether the faces have texture coordinates that are not all zero, which is what faces without any get where others
/// of the surface have some.
bool has_texture(const Piece& piece, const std::vector<int>& faces);

/// Of some of a piece's faces. Corners at one vertex are one where all they carry is equal. `uv`: with texture
/// coordinates, zero where there are none. Damage times that are all unknown are left out.
VertexArrays vertex_arrays(const Piece& piece, const std::vector<int>& faces, bool uv);

}  // namespace sunder::output::detail
