#pragma once
/// What the writers of a sequence share.
#include <set>
#include <string>
#include <vector>

#include "pipeline/sequence.h"

namespace sunder::pipeline::detail {

/// Throws ErrorKind::internal when a pose of the frame is not finite: NaN must not reach a file.
void require_finite(const Sequence& sequence, const Frame& frame);

/// Names of the materials of all pieces, sorted.
std::set<std::string> material_names(const Sequence& sequence);

/// Faces of the piece that cracks made, or those that they did not.
std::vector<geometry::Triangle> faces_of(const Piece& piece, bool inside);

}  // namespace sunder::pipeline::detail
