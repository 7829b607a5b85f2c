#include "pipeline/hard_cases.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "geometry/inspect.h"
#include "geometry/mass_properties.h"
#include "geometry/primitives.h"
#include "pipeline/detail/hard_cases.h"

namespace sunder::pipeline {
namespace detail {
namespace {

namespace fs = std::filesystem;
using validation::absolute;
using validation::Check;
using validation::Outcome;
using validation::within;

/// The sum of the fragments' volumes is rounded once per cut point.
constexpr double volume_kept = 1e-9;
/// The books of the contact close to first order in the time step.
constexpr double work_allowed = 1.001;

/// A folder of its own that is gone in the end.
class Scratch {
 public:
  Scratch() {
    std::string pattern = (fs::temp_directory_path() / "sunder_hard_XXXXXX").string();
    if (!mkdtemp(pattern.data()))
      throw Error(ErrorKind::io, "cannot create a folder in " + fs::temp_directory_path().string());
    folder_ = pattern;
  }
  ~Scratch() {
    std::error_code ignored;
    fs::remove_all(folder_, ignored);
  }
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;
  const fs::path& folder() const { return folder_; }

 private:
  fs::path folder_;
};

/// Asks for a stop after so many looks; negative: never.
class Impatient final : public Progress {
 public:
  explicit Impatient(int looks) : left_(looks) {}
  void report(std::string_view, double) override {}
  bool cancelled() const override { return left_.load() >= 0 && left_.fetch_sub(1) <= 0; }

 private:
  mutable std::atomic<int> left_;
};

Scene scene_in(const fs::path& folder, const std::string& toml) {
  const fs::path file = folder / "hard.toml";
  std::ofstream(file) << toml;
  Scene scene = load_scene(file);
  Outputs& o = scene.outputs;
  o.obj = o.glb = o.page = o.poster = o.blender = o.fragments_csv = false;
  o.checkpoint_interval = 0;
  return scene;
}

bool finite(const output::PiecePose& p) {
  return p.pose.position.allFinite() && p.pose.orientation.coeffs().allFinite() && p.twist.linear.allFinite() &&
         p.twist.angular.allFinite();
}

/// Of translation and height; rotation is left out, so it can only come out too low.
double mechanical_energy(const output::Sequence& sequence, const output::Frame& frame, const Vec3& gravity) {
  double energy = 0;
  for (const output::PiecePose& p : frame.poses) {
    const double mass = sequence.pieces[static_cast<std::size_t>(p.piece)].mass;
    energy += mass * (0.5 * p.twist.linear.squaredNorm() - gravity.dot(p.pose.position));
  }
  return energy;
}

/// Largest rise of the energy over that of the first frame, over what moves or can fall at all.
double energy_growth(const RunResult& result, const Scene& scene) {
  const auto& frames = result.sequence.frames;
  double first = mechanical_energy(result.sequence, frames.front(), scene.gravity), most = first, least = first,
         turning = 0;
  for (const SceneBody& body : scene.bodies) turning += body.angular_velocity.squaredNorm();
  for (const output::Frame& frame : frames) {
    const double e = mechanical_energy(result.sequence, frame, scene.gravity);
    most = std::max(most, e);
    least = std::min(least, e);
  }
  double kinetic = 0;
  for (const output::PiecePose& p : frames.front().poses)
    kinetic += 0.5 * result.sequence.pieces[static_cast<std::size_t>(p.piece)].mass * p.twist.linear.squaredNorm();
  const double scale = std::max(kinetic, first - least);
  return turning > 0 || scale <= 0 ? 0 : (most - first) / scale;
}

}  // namespace

Material hard_glass() { return {"glass", 2500, 70e9, 0.22, 40e6, 8, 5.5e9, 8, 0.4, 0.4, true, ""}; }

FractureInput steel_ball_on(const geometry::TriangleMesh& mesh, const Material& material, double speed, int particles) {
  const Box box = geometry::bounds(mesh);
  const double radius = 0.05 * box.sizes().maxCoeff();
  FractureInput input;
  input.mesh = mesh;
  input.material = material;
  input.particles = particles;
  mpm::Load load;
  load.point = box.center() + Vec3(0.11 * box.sizes()[0], 0.5 * box.sizes()[1], 0.07 * box.sizes()[2]);
  load.outward = Vec3::UnitY();
  load.approach_speed = speed;
  load.pair = {radius, mpm::effective_modulus(material.youngs_modulus, material.poisson_ratio, 210e9, 0.3),
               material.contact_pressure};
  input.loads = {load};
  input.partners = {{7800 * 4.19 * radius * radius * radius}};
  return input;
}

FractureOutcome sound_fracture(const FractureInput& input, const std::string& what, Outcome& outcome) {
  SilentProgress progress;
  FractureOutcome result = fracture(input, progress);
  const double volume = geometry::mass_properties(input.mesh).volume;
  double sum = 0, open = 0, wild = 0;
  for (const BrokenPiece& piece : result.pieces) {
    open += !geometry::inspect(piece.fragment.mesh).is_solid();
    wild += !(piece.twist.linear.allFinite() && piece.twist.angular.allFinite());
    sum += geometry::mass_properties(piece.fragment.mesh).volume;
  }
  for (const mpm::ParticleState& p : result.solve.particles)
    wild += !(p.displacement.allFinite() && p.velocity.allFinite() && std::isfinite(p.damage));
  const std::string pieces = what + ": " + std::to_string(std::max<std::size_t>(1, result.pieces.size())) +
                             (result.pieces.size() < 2 ? " piece; " : " pieces; ");
  outcome.checks.push_back(absolute(pieces + "values that are not finite", wild, 0, 0));
  outcome.checks.push_back(absolute(what + ": pieces that are not closed", open, 0, 0));
  outcome.checks.push_back(
      absolute(what + ": volume of the pieces [body]", result.pieces.empty() ? 1 : sum / volume, 1, volume_kept));
  outcome.checks.push_back(within(what + ": work of the contact [impact energy]",
                                  result.solve.work / result.solve.impact_energy, 0, work_allowed));
  outcome.checks.push_back(
      absolute(what + ": fractures given up", static_cast<double>(result.fallbacks.count("fracture_abandoned")), 0, 0));
  outcome.particle_steps += static_cast<double>(result.particles) * static_cast<double>(result.solve.steps);
  return result;
}

Check refused(const std::string& what, ErrorKind kind, const std::string& word, const std::function<void()>& action) {
  std::string answer = "no refusal";
  bool right = false;
  try {
    action();
  } catch (const Error& error) {
    answer = error.what();
    right = error.kind() == kind && answer.find(word) != std::string::npos;
    // Where the scratch folder was is of no interest.
    if (const std::size_t at = answer.find("hard.toml"); at != std::string::npos) answer.erase(0, at);
  }
  return {what + ": refused, \"" + answer + "\"", right ? 1.0 : 0.0, 1, right ? 0.0 : 1.0, 0};
}

RunResult sound_run(const std::string& toml, const std::string& what, Outcome& outcome) {
  const Scratch scratch;
  const Scene scene = scene_in(scratch.folder(), toml);
  SilentProgress progress;
  RunResult result = run(scene, {.out = scratch.folder() / "out"}, progress);
  double wild = 0, open = 0, volume_error = 0;
  for (const output::Frame& frame : result.sequence.frames)
    wild += static_cast<double>(
        std::count_if(frame.poses.begin(), frame.poses.end(), [](const auto& p) { return !finite(p); }));
  for (const output::Piece& piece : result.sequence.pieces) open += !piece.closed;
  for (const FractureRecord& f : result.report.fractures) volume_error = std::max(volume_error, f.volume_error);
  const std::string pieces = what + ": " + std::to_string(result.sequence.frames.back().poses.size()) + " pieces, " +
                             std::to_string(result.report.fractures.size()) + " solves; ";
  outcome.checks.push_back(absolute(pieces + "poses that are not finite", wild, 0, 0));
  outcome.checks.push_back(absolute(what + ": pieces that are not closed", open, 0, 0));
  outcome.checks.push_back(absolute(what + ": volume lost in cuts [body]", volume_error, 0, volume_kept));
  outcome.checks.push_back(
      within(what + ": growth of the mechanical energy [of what moves]", energy_growth(result, scene), -1e9, 0.01));
  outcome.particle_steps += static_cast<double>(result.report.particle_steps);
  return result;
}

void stopped_run(const std::string& toml, int stops, Outcome& outcome) {
  const Scratch scratch;
  const Scene scene = scene_in(scratch.folder(), toml);
  SilentProgress silent;
  const RunResult straight = run(scene, {.out = scratch.folder() / "straight"}, silent);
  double stopped = 0;
  RunResult result;
  for (int n = 0; n <= stops; ++n) {
    Impatient impatient(n < stops ? 40 * (n + 1) : -1);
    result = run(scene, {.out = scratch.folder() / "stopped", .resume = n > 0}, impatient);
    stopped += result.report.interrupted;
    if (!result.report.interrupted) break;
  }
  const auto &a = straight.sequence, &b = result.sequence;
  double differing = std::abs(static_cast<double>(a.pieces.size()) - static_cast<double>(b.pieces.size())) +
                     std::abs(static_cast<double>(a.frames.size()) - static_cast<double>(b.frames.size()));
  for (std::size_t f = 0; differing == 0 && f < a.frames.size(); ++f)
    for (std::size_t p = 0; p < a.frames[f].poses.size(); ++p)
      differing += a.frames[f].poses[p].pose.position != b.frames[f].poses[p].pose.position ||
                   a.frames[f].poses[p].twist.linear != b.frames[f].poses[p].twist.linear;
  outcome.checks.push_back(within("stops", stopped, 1, stops));
  outcome.checks.push_back(absolute("poses and pieces that differ from those of a straight run", differing, 0, 0));
}

void load_text(const std::string& toml) {
  const Scratch scratch;
  scene_in(scratch.folder(), toml);
}

}  // namespace detail

const std::vector<validation::Problem>& hard_cases() {
  static const std::vector<validation::Problem> all = [] {
    std::vector<validation::Problem> list;
    for (const auto& part : {detail::hard_solves(), detail::hard_shapes(), detail::hard_scenes()})
      list.insert(list.end(), part.begin(), part.end());
    std::stable_sort(list.begin(), list.end(), [](const auto& a, const auto& b) {
      return std::pair(a.id[0], std::stoi(a.id.substr(1))) < std::pair(b.id[0], std::stoi(b.id.substr(1)));
    });
    return list;
  }();
  return all;
}

}  // namespace sunder::pipeline
