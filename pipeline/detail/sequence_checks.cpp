#include "pipeline/detail/sequence_checks.h"

#include "core/error.h"

namespace sunder::pipeline::detail {

void require_finite(const Sequence& sequence, const Frame& frame) {
  for (const auto& [piece, pose] : frame.poses) {
    if (pose.position.allFinite() && pose.orientation.coeffs().allFinite()) continue;
    const std::string name = sequence.pieces.at(static_cast<std::size_t>(piece)).name;
    throw Error(ErrorKind::internal,
                "the pose of '" + name + "' is not finite at " + std::to_string(frame.time) + " s");
  }
}

std::set<std::string> material_names(const Sequence& sequence) {
  std::set<std::string> names;
  for (const Piece& piece : sequence.pieces) names.insert(piece.material);
  return names;
}

std::vector<geometry::Triangle> faces_of(const Piece& piece, bool inside) {
  std::vector<geometry::Triangle> faces;
  for (std::size_t i = 0; i < piece.mesh.faces.size(); ++i) {
    // A piece that no crack has touched may come without marks.
    const bool made_by_crack = i < piece.inside.size() && piece.inside[i];
    if (made_by_crack == inside) faces.push_back(piece.mesh.faces[i]);
  }
  return faces;
}

}  // namespace sunder::pipeline::detail
