#include "batch/work.h"

#include <algorithm>
#include <new>

#include <nlohmann/json.hpp>
#include <unistd.h>

#include "batch/detail/job_keys.h"
#include "batch/detail/parameters_json.h"
#include "core/hash.h"
#include "core/resources.h"
#include "core/stopwatch.h"
#include "output/atomic_file.h"
#include "output/checksum.h"
#include "output/dataset.h"
#include "output/poster.h"
#include "output/writers.h"
#include "pipeline/crack_writer.h"
#include "pipeline/fragment_statistics.h"
#include "pipeline/random_impact.h"
#include "pipeline/run.h"
#include "pipeline/version.h"

namespace sunder::batch {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr output::PosterSettings still_settings{.width = 320, .height = 240, .samples = 4, .fill = 0.85};
constexpr double opening = 0.35;  // of a still: how far pieces are moved apart, over their distance from the middle

Json json_of(const Vec3& x) { return {x.x(), x.y(), x.z()}; }

Json head_of(const Job& job) {
  return {{"id", job.id}, {"build", pipeline::build_name()}, {"parameters", detail::parameters_json(job)}};
}

/// Files of the folder, in the order of their names.
Json files_json(const fs::path& folder) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    if (entry.is_regular_file()) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  Json list = Json::array();
  for (const fs::path& file : files)
    list.push_back({{"name", file.lexically_relative(folder).generic_string()},
                    {"bytes", fs::file_size(file)},
                    {"sha256", output::sha256_of_file(file)}});
  return list;
}

/// The pieces that there are in the last frame.
std::vector<const output::Piece*> last_pieces(const output::Sequence& sequence) {
  std::vector<const output::Piece*> pieces;
  for (const output::PiecePose& pose : sequence.frames.back().poses)
    pieces.push_back(&sequence.pieces[static_cast<std::size_t>(pose.piece)]);
  return pieces;
}

void add_pieces(Json& result, const output::Sequence& sequence, const pipeline::Report& report) {
  Json list = Json::array();
  std::vector<double> volumes;
  double inside_area = 0;
  for (const output::Piece* piece : last_pieces(sequence)) {
    inside_area += piece->inside_area;
    if (piece->parent < 0) continue;
    volumes.push_back(piece->volume);
    list.push_back({{"name", piece->name},
                    {"volume", piece->volume},
                    {"mass", piece->mass},
                    {"area", piece->area},
                    {"inside_area", piece->inside_area},
                    {"closed", piece->closed}});
  }
  double damaged = 0, work = 0;
  for (const pipeline::FractureRecord& f : report.fractures) {
    damaged = std::max(damaged, f.damaged_share);
    if (f.energy) work += f.energy->work;
  }
  result["outcome"] = !volumes.empty() ? "broken" : "whole";
  result["error"] = nullptr;
  result["fragments"] = volumes.size();
  result["largest_share"] = volumes.empty() ? 1.0 : pipeline::largest_share(volumes);
  result["crack_area"] = inside_area / 2;  // each crack has two sides
  result["work"] = work;
  result["damaged_share"] = damaged;
  result["fallbacks"] = report.fallbacks;
  result["notes"] = report.notes;
  result["pieces"] = std::move(list);
}

Json impact_json(const pipeline::StillImpact& impact) {
  return {{"at", json_of(impact.at)},
          {"direction", json_of(impact.direction)},
          {"impulse", impact.impulse},
          {"speed", impact.speed},
          {"energy", impact.energy}};
}

/// Pieces moved apart, so that a picture shows them.
output::Sequence opened(output::Sequence sequence) {
  Vec3 middle = Vec3::Zero();
  double volume = 0;
  for (const output::Piece* piece : last_pieces(sequence)) {
    middle += piece->volume * piece->birth_position;
    volume += piece->volume;
  }
  if (volume > 0) middle /= volume;
  for (output::PiecePose& pose : sequence.frames.back().poses)
    pose.pose.position += opening * (sequence.pieces[static_cast<std::size_t>(pose.piece)].birth_position - middle);
  return sequence;
}

void keep_pieces(const pipeline::StillResult& result, const Plan& plan, std::uint64_t seed, const fs::path& folder) {
  const output::Sequence& sequence = result.sequence;
  // Of a body that stayed whole the original says it all.
  if (plan.keep.dataset && sequence.pieces.size() > 1)
    output::write_atomically(folder / "pieces.npz", output::pieces_npz(sequence, 0, plan.points, seed));
  if (plan.keep.still)
    output::write_atomically(folder / "still.png", output::poster_png(opened(sequence), 0, {}, still_settings));
  if (plan.keep.glb) output::write_glb(sequence, folder / "pieces.glb");
  if (plan.keep.cracks) pipeline::write_crack_surface(result.cracks, folder / "cracks.ply");
  if (!plan.keep.obj) return;
  output::create_folder(folder / "pieces");
  for (const output::Piece* piece : last_pieces(sequence))
    output::write_obj_piece(*piece, folder / "pieces" / (piece->name + ".obj"));
}

void write_json(const fs::path& file, const Json& json) { output::write_atomically(file, json.dump(1) + "\n"); }

Json failure_json(const Job& job, int code, const std::string& message) {
  Json result = head_of(job);
  result["outcome"] = "failed";
  result["error"] = {{"code", code}, {"message", message}};
  result["files"] = Json::array();
  return result;
}

/// A full disk is no fault of the job.
bool is_of_writing(const Error& error, const fs::path& folder) {
  return error.kind() == ErrorKind::io && std::string(error.what()).find(folder.string()) != std::string::npos;
}

/// Parameters that decide what is loaded.
std::string loading_key(const Job& job) {
  std::string key;
  for (const char* name : {"mesh", "unit", "up", "part", "height", "material"}) key += value_of(job, name) + "\n";
  return key;
}

std::string name_of_original(const std::string& key) {
  Hash hash;
  hash.add(key);
  return hash.digits() + ".npz";
}

/// The report alone.
pipeline::Outputs quiet(pipeline::Outputs o) {
  o.obj = o.ply = o.glb = o.usd = o.fragments_csv = o.vdb = o.page = o.poster = o.blender = false;
  o.transforms = pipeline::TransformTable::off;
  o.checkpoint_interval = 0;
  return o;
}

}  // namespace

const pipeline::StillBody& Worker::loaded(const Job& job, const pipeline::FractureOptions& options) {
  const std::string key = loading_key(job);
  if (loaded_ && loaded_->of == key) return loaded_->body;
  loaded_.reset();
  loaded_.emplace(Loaded{key, pipeline::load_still_body(options)});
  return loaded_->body;
}

void Worker::keep_original(const std::string& name, const geometry::TriangleMesh& mesh) const {
  const fs::path file = out_ / "originals" / name;
  std::error_code ignored;
  if (fs::exists(file, ignored)) return;
  output::create_folder(file.parent_path());
  output::write_atomically(file, output::mesh_npz(mesh));
}

Worker::Told Worker::fracture(const Job& job, const fs::path& folder) {
  detail::FractureJob choice = detail::fracture_job(plan_, job);
  pipeline::FractureOptions& options = choice.options;
  double load_seconds = 0, keep_seconds = 0;
  const pipeline::StillBody& body = [&]() -> const pipeline::StillBody& {
    const Stopwatch watch(load_seconds);
    return loaded(job, options);
  }();
  if (choice.random_impact) {
    const pipeline::ImpactPoint impact = pipeline::random_impact(body.source.mesh, *choice.random_impact, options.seed);
    options.at = impact.at;
    options.direction = impact.direction;
  }
  SilentProgress progress;
  const pipeline::StillResult still = pipeline::break_still_body(body, options, progress);
  {
    const Stopwatch watch(keep_seconds);
    Json result = head_of(job);
    if (plan_.keep.dataset) {
      const std::string original = name_of_original(job.content + loading_key(job));
      keep_original(original, body.source.mesh);
      result["original"] = "originals/" + original;
    }
    if (still.impact) result["impact"] = impact_json(*still.impact);
    keep_pieces(still, plan_, options.seed, folder);
    add_pieces(result, still.sequence, still.report);
    result["files"] = files_json(folder);
    write_json(folder / "result.json", result);
  }
  const auto& s = still.report.seconds;
  return {pipeline::summary(still.report, still.sequence),
          {{"load", load_seconds},
           {"sample", s.sample},
           {"solve", s.solve},
           {"extract", s.extract},
           {"cut", s.cut},
           {"keep", keep_seconds}}};
}

Worker::Told Worker::run(const Job& job, const fs::path& folder) {
  pipeline::Scene scene = detail::scene_of(plan_, job);
  if (!plan_.keep.sequence) scene.outputs = quiet(scene.outputs);
  SilentProgress progress;
  pipeline::RunOptions options;
  options.out = folder / "run";
  const pipeline::RunResult done = pipeline::run(scene, options, progress);
  if (plan_.keep.still)
    output::write_poster(done.sequence, scene.ground ? std::optional(scene.ground->height) : std::nullopt,
                         folder / "still.png", still_settings);
  Json result = head_of(job);
  add_pieces(result, done.sequence, done.report);
  result["files"] = files_json(folder);
  write_json(folder / "result.json", result);
  const auto& s = done.report.seconds;
  return {pipeline::summary(done.report, done.sequence),
          {{"setup", s.setup},
           {"rigid", s.rigid},
           {"sample", s.sample},
           {"solve", s.solve},
           {"extract", s.extract},
           {"cut", s.cut},
           {"export", s.write}}};
}

JobEnd Worker::work(const Job& job) {
  const fs::path folder = results_.begin(job.id);
  JobEnd end;
  const double processor = cpu_seconds();
  restart_peak_memory();
  Told told;
  const auto fail = [&](int code, const std::string& message) {
    end.failed = true;
    write_json(folder / "result.json", failure_json(job, code, message));
    told = {message + "\n", {}};
  };
  {
    const Stopwatch watch(end.seconds);
    try {
      told = plan_.mode == Mode::fracture ? fracture(job, folder) : run(job, folder);
    } catch (const Error& error) {
      if (is_of_writing(error, folder)) throw;
      fail(static_cast<int>(error.kind()), error.what());
    } catch (const std::bad_alloc&) {
      fail(static_cast<int>(ErrorKind::internal), "out of memory");
    } catch (const std::exception& error) {
      fail(static_cast<int>(ErrorKind::internal), std::string("internal failure: ") + error.what());
    }
  }
  end.processor_seconds = cpu_seconds() - processor;
  end.memory_mb = peak_memory_mb();
  output::write_atomically(folder / "log.txt", told.log);
  Json stages = Json::object();
  for (const auto& [stage, seconds] : told.stages) stages[stage] = seconds;
  write_json(folder / "measured.json", {{"seconds", end.seconds},
                                        {"processor_seconds", end.processor_seconds},
                                        {"peak_memory_mb", end.memory_mb},
                                        {"host", host_name()},
                                        {"stages", std::move(stages)}});
  results_.commit(job.id, folder);
  return end;
}

void write_failure(const Job& job, const Results& results, int code, const std::string& message) {
  const fs::path folder = results.begin(job.id);
  write_json(folder / "result.json", failure_json(job, code, message));
  output::write_atomically(folder / "log.txt", message + "\n");
  results.commit(job.id, folder);
}

}  // namespace sunder::batch
