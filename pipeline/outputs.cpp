#include "pipeline/outputs.h"

#include <set>

#include "geometry/damage_volume.h"
#include "output/atomic_file.h"
#include "output/fragments_table.h"
#include "output/poster.h"
#include "output/writers.h"

namespace sunder::pipeline {
namespace {

namespace fs = std::filesystem;

/// Of the files that come one a frame.
int first_frame(const Scene& scene) { return scene.outputs.first_frame.value_or(scene.start_frame); }

bool in_range(const Scene& scene, int frame) { return frame >= first_frame(scene) && frame <= last_frame(scene); }

int newest_piece(const output::Sequence& sequence, std::size_t frame) {
  const auto& poses = sequence.frames[frame].poses;
  return poses.empty() ? -1 : poses.back().piece;
}

int frame_of(const Scene& scene, double time) { return output::frame_at(time, scene.frame_rate, scene.start_frame); }

std::string volume_name(const Scene& scene, const FractureRecord& record) {
  return record.body + "." + output::frame_number(frame_of(scene, record.time)) + ".vdb";
}

/// The number between `head` and `extension` of a file name; nothing when it is another file.
std::optional<int> number_of(const fs::path& file, const std::string& head, const std::string& extension) {
  const std::string name = file.filename().string();
  if (name.size() <= head.size() + extension.size() || !name.starts_with(head) || !name.ends_with(extension)) return {};
  const std::string digits = name.substr(head.size(), name.size() - head.size() - extension.size());
  const std::size_t sign = digits[0] == '-' ? 1 : 0;
  constexpr std::size_t kMostDigits = 9;
  if (digits.size() == sign || digits.size() > kMostDigits ||
      digits.find_first_not_of("0123456789", sign) != std::string::npos)
    return {};
  return std::stoi(digits);
}

void remove_stale_frames(const Scene& scene, const std::string& extension, const fs::path& folder) {
  for (const auto& entry : fs::directory_iterator(folder)) {
    const std::optional<int> frame = number_of(entry.path(), scene.name + ".", extension);
    if (frame && !in_range(scene, *frame)) fs::remove(entry.path());
  }
}

void remove_stale_solves(const Scene& scene, const Report& report, const fs::path& folder) {
  if (!fs::is_directory(folder)) return;
  std::set<std::string> written;
  for (const FractureRecord& record : report.fractures) written.insert(volume_name(scene, record));
  for (const auto& entry : fs::directory_iterator(folder))
    if (entry.path().extension() == ".vdb" && !written.contains(entry.path().filename().string()))
      fs::remove(entry.path());
}

bool wants_csv(const Outputs& outputs) {
  return outputs.transforms == TransformTable::csv || outputs.transforms == TransformTable::both;
}

bool wants_jsonl(const Outputs& outputs) {
  return outputs.transforms == TransformTable::jsonl || outputs.transforms == TransformTable::both;
}

}  // namespace

std::vector<PlannedFiles> planned_files(const Scene& scene) {
  const Outputs& outputs = scene.outputs;
  const int frames = last_frame(scene) - first_frame(scene) + 1;
  std::vector<PlannedFiles> files;
  if (outputs.obj) files.push_back({scene.name + ".####.obj", frames});
  if (outputs.obj) files.push_back({scene.name + ".mtl"});
  if (outputs.ply) files.push_back({scene.name + ".####.ply", frames});
  if (outputs.vdb) files.push_back({"vdb/<piece>.####.vdb", 0});
  if (outputs.glb) files.push_back({"fragments.glb"});
  if (outputs.usd) files.push_back({"fragments.usda"});
  if (outputs.fragments_csv) files.push_back({"fragments.csv"});
  if (wants_csv(outputs)) files.push_back({"transforms.csv"});
  if (wants_jsonl(outputs)) files.push_back({"transforms.jsonl"});
  if (outputs.blender) files.push_back({"import_blender.py"});
  if (outputs.poster) files.push_back({"poster.png"});
  files.push_back({"scene.toml"});
  files.push_back({"report.json"});
  if (outputs.page) files.push_back({"index.html"});
  return files;
}

void write_newest_frame(const Scene& scene, const output::Sequence& sequence, const fs::path& folder,
                        output::ObjFrames& obj) {
  const std::size_t frame = sequence.frames.size() - 1;
  const int number = sequence.start_frame + static_cast<int>(frame);
  if (!in_range(scene, number)) return;
  if (scene.outputs.ply) output::write_ply_frame(sequence, frame, folder);
  if (!scene.outputs.obj) return;
  obj.write(sequence, frame, folder);
  if (frame == 0 || number == first_frame(scene) || newest_piece(sequence, frame) > newest_piece(sequence, frame - 1))
    output::write_obj_materials(sequence, folder);
}

void write_solve(const Scene& scene, const SettledSolve& solve, const fs::path& folder) {
  if (!scene.outputs.vdb || !in_range(scene, frame_of(scene, solve.record.time))) return;
  std::vector<double> damage, damage_time;
  for (const mpm::ParticleState& particle : solve.outcome.solve.particles) {
    damage.push_back(particle.damage);
    damage_time.push_back(particle.damage_time);
  }
  const geometry::Samples& samples = solve.outcome.own->samples;
  output::create_folder(folder / "vdb");
  output::write_atomically(
      folder / "vdb" / volume_name(scene, solve.record),
      geometry::damage_volume(solve.input.mesh, {samples.points, damage, damage_time, samples.spacing}, solve.pose));
}

void write_whole_run(const Scene& scene, const output::Sequence& sequence, const fs::path& folder) {
  if (scene.outputs.glb) output::write_glb(sequence, folder / "fragments.glb");
  if (scene.outputs.usd) output::write_usda(sequence, folder / "fragments.usda");
  if (scene.outputs.fragments_csv) output::write_fragments_csv(sequence, folder / "fragments.csv");
  if (wants_csv(scene.outputs)) output::write_transforms_csv(sequence, folder / "transforms.csv");
  if (wants_jsonl(scene.outputs)) output::write_transforms_jsonl(sequence, folder / "transforms.jsonl");
  if (scene.outputs.blender) output::write_blender_script(folder);
  if (scene.outputs.poster)
    output::write_poster(sequence, scene.ground ? std::optional(scene.ground->height) : std::nullopt,
                         folder / "poster.png");
}

void remove_stale_files(const Scene& scene, const Report& report, const fs::path& folder) {
  if (scene.outputs.obj) remove_stale_frames(scene, ".obj", folder);
  if (scene.outputs.ply) remove_stale_frames(scene, ".ply", folder);
  if (scene.outputs.vdb) remove_stale_solves(scene, report, folder / "vdb");
}

}  // namespace sunder::pipeline
