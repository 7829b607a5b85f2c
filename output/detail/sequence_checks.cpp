#include "output/detail/sequence_checks.h"

#include "core/error.h"

namespace sunder::output::detail {

void require_finite(const Sequence& sequence, const Frame& frame) {
  for (const auto& [piece, pose, twist] : frame.poses) {
    if (pose.position.allFinite() && pose.orientation.coeffs().allFinite() && twist.linear.allFinite() &&
        twist.angular.allFinite())
      continue;
    const std::string name = sequence.pieces.at(static_cast<std::size_t>(piece)).name;
    throw Error(ErrorKind::internal,
                "the pose of '" + name + "' is not finite at " + std::to_string(frame.time) + " s");
  }
}

std::map<std::string, std::string> surface_materials(const Sequence& sequence) {
  std::map<std::string, std::string> substance;
  for (const Piece& piece : sequence.pieces)
    for (const std::string& name : piece.surface.material_names) substance.try_emplace(name, piece.material);
  return substance;
}

std::vector<MaterialFaces> faces_by_material(const Piece& piece) {
  std::vector<MaterialFaces> groups(piece.surface.material_names.size());
  for (std::size_t f = 0; f < piece.mesh.faces.size(); ++f)
    groups[static_cast<std::size_t>(piece.surface.material[f])].faces.push_back(static_cast<int>(f));
  for (std::size_t m = 0; m < groups.size(); ++m) groups[m].material = static_cast<int>(m);
  std::erase_if(groups, [](const MaterialFaces& group) { return group.faces.empty(); });
  return groups;
}

}  // namespace sunder::output::detail
