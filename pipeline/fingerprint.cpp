#include "pipeline/fingerprint.h"

#include <set>

#include "core/hash.h"

namespace sunder::pipeline {

namespace fs = std::filesystem;

std::string fingerprint(const Scene& scene) {
  Hash hash;
  hash.add_file(scene.file);
  for (const Override& change : scene.overrides) hash.add(change.key + " = " + change.value);
  hash.add_file(default_assets().materials);
  hash.add_file(default_assets().meshes);
  std::set<fs::path> meshes;
  for (const SceneBody& body : scene.bodies) meshes.insert(body.mesh.file);
  for (const fs::path& mesh : meshes) hash.add_file(mesh);
  for (const double number : {scene.duration, scene.frame_rate}) hash.add(number);
  hash.add(scene.time_budget ? "within " + std::to_string(*scene.time_budget) : name_of(scene.quality));
  for (const auto& frame : {scene.outputs.first_frame, scene.outputs.last_frame})
    hash.add(frame ? std::to_string(*frame) : "all");
  hash.add(std::to_string(scene.seed));
  return hash.digits();
}

}  // namespace sunder::pipeline
