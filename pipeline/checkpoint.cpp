#include "pipeline/checkpoint.h"

#include <fstream>
#include <set>
#include <sstream>

#include "core/error.h"
#include "core/hash.h"
#include "output/atomic_file.h"
#include "pipeline/detail/archive.h"
#include "pipeline/version.h"

namespace sunder::pipeline {
namespace {

namespace fs = std::filesystem;

const std::string magic = "sunder checkpoint 1\n";
const std::string build = build_name();

std::string hash_of(std::string_view bytes) {
  Hash hash;
  hash.add(bytes);
  return hash.digits();
}

[[noreturn]] void damaged(const fs::path& file, const std::string& what) {
  throw Error(ErrorKind::io, file.string() + ": " + what + "; run without --resume to start again");
}

/// What stands before the state.
struct Header {
  std::string build, scene, state_hash;
};

template <class Archive>
void serialize(Archive& archive, Header& header) {
  archive(header.build, header.scene, header.state_hash);
}

}  // namespace

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

void write_checkpoint(const fs::path& file, const std::string& scene_fingerprint, int steps,
                      const Simulation& simulation) {
  std::ostringstream state(std::ios::binary);
  {
    cereal::BinaryOutputArchive archive(state);
    archive(steps, simulation.world_state(), simulation.state());
  }
  std::ostringstream out(std::ios::binary);
  out << magic;
  cereal::BinaryOutputArchive header(out);
  header(Header{build, scene_fingerprint, hash_of(state.view())});
  out << state.view();
  output::write_atomically(file, out.view());
}

std::optional<Checkpoint> read_checkpoint(const fs::path& file, const std::string& scene_fingerprint) {
  std::ifstream in(file, std::ios::binary);
  if (!in) return std::nullopt;
  std::string first(magic.size(), '\0');
  if (!in.read(first.data(), static_cast<std::streamsize>(first.size())) || first != magic)
    damaged(file, "not a checkpoint of this version");
  try {
    Header header;
    cereal::BinaryInputArchive head(in);
    head(header);
    if (header.build != build)
      throw Error(ErrorKind::usage, file.string() + ": the checkpoint is of build " + header.build + ", this is " +
                                        build + "; resume with that one, or run without --resume to start again");
    if (header.scene != scene_fingerprint)
      throw Error(ErrorKind::usage, file.string() +
                                        ": the checkpoint is of another scene, or the scene, a mesh, the seed or the "
                                        "quality has changed since; run without --resume to start again");
    std::ostringstream rest(std::ios::binary);
    rest << in.rdbuf();
    if (hash_of(rest.view()) != header.state_hash) damaged(file, "the checkpoint is damaged");
    std::istringstream state(rest.str(), std::ios::binary);
    cereal::BinaryInputArchive archive(state);
    Checkpoint checkpoint;
    archive(checkpoint.steps, checkpoint.world, checkpoint.simulation);
    return checkpoint;
  } catch (const cereal::Exception&) {
    damaged(file, "the checkpoint is damaged");
  }
}

}  // namespace sunder::pipeline
