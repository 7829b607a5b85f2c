#pragma once
/// What the writers of a sequence share.
#include <map>
#include <string>
#include <vector>

#include "output/sequence.h"

namespace sunder::output::detail {

/// Throws ErrorKind::internal when a pose of the frame is not finite: NaN must not reach a file.
void require_finite(const Sequence& sequence, const Frame& frame);

/// Names of the materials of all surfaces, with the substance that each is of.
std::map<std::string, std::string> surface_materials(const Sequence& sequence);

/// Faces of a piece that have one material.
struct MaterialFaces {
  int material = 0;  ///< index into the surface's names
  std::vector<int> faces;
};

/// By material, those without faces left out.
std::vector<MaterialFaces> faces_by_material(const Piece& piece);

}  // namespace sunder::output::detail
