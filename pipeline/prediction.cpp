#include "pipeline/prediction.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <thread>

#include <tbb/task_arena.h>

#include "core/resources.h"
#include "geometry/primitives.h"

namespace sunder::pipeline {
namespace {

// Fitted on the scenes of assets/scenes at draft and preview quality: processor seconds of the machine of
// docs/accuracy.md while nothing else ran on it.
namespace fitted {
constexpr double particle_step = 8e-8;   ///< [s]
constexpr double particle_break = 4e-5;  ///< of sampling, crack surfaces and cut, per particle [s]
constexpr double cubic = 1.9;            ///< over quadratic splines
constexpr double two_fields = 1.4;       ///< over one
constexpr double finer_pieces = 1.5;     ///< pieces of any quality over those of the pilot
constexpr double start = 1;              ///< of the program, the tables and the page [s]
constexpr double poster = 3;             ///< [s]
constexpr double face_frame = 2e-7;      ///< of a face in a frame of the OBJ sequence [s]
constexpr double serial_share = 0.2;     ///< of the processor time: one thread only
constexpr double program_mb = 125;
constexpr double particle_mb = 2.5e-3;  ///< of a solve
constexpr double face_mb = 3e-4;
constexpr double fragment_mb = 0.3;  ///< of its contacts with those that were one with it
}  // namespace fitted

/// The machine that the constants are of took so long for the solve below [s].
constexpr double reference_seconds = 0.058;

const Quality pilot_quality = Quality::of(800);

FractureInput probe() {
  FractureInput input;
  input.mesh = geometry::box(Vec3::Constant(0.1));
  input.material = {"probe", 2500, 70e9, 0.22, 1e12, 1e6, 1e12, 0, 0.4, 0.4, true, ""};
  mpm::Load load;
  load.point = Vec3(0, 0.05, 0);
  load.approach_speed = 1;
  load.pair = {0.01, mpm::effective_modulus(70e9, 0.22, 210e9, 0.3)};
  input.loads = {load};
  input.partners = {{0.03}};
  input.particles = 8000;
  input.solve.most_steps = 150;
  return input;
}

int threads_of(int asked) { return asked > 0 ? asked : static_cast<int>(std::thread::hardware_concurrency()); }

Scene at_pilot_quality(Scene scene) {
  scene.quality = pilot_quality;
  return scene;
}

/// What a value that was followed over `steps.size()` of `all` steps comes to in the end, if what is left goes on as
/// the last fifth of what was followed did.
double extrapolated(const std::vector<double>& steps, long all) {
  const double sum = std::accumulate(steps.begin(), steps.end(), 0.0);
  const long done = static_cast<long>(steps.size()), last = std::max(1L, done / 5);
  if (done >= all || done == 0) return sum;
  const double rate = std::accumulate(steps.end() - last, steps.end(), 0.0) / static_cast<double>(last);
  return sum + rate * static_cast<double>(all - done);
}

}  // namespace

double measured_slowness() {
  SilentProgress progress;
  double best = std::numeric_limits<double>::infinity();
  for (int n = 0; n < 2; ++n) {
    const double start = cpu_seconds();
    // On one thread: what threads wait for when others are busy is not the machine's speed.
    tbb::task_arena(1).execute([&] { fracture(probe(), progress); });
    best = std::min(best, cpu_seconds() - start);
  }
  return best / reference_seconds;
}

Forecaster::Forecaster(const Scene& scene, const Simulation& simulation, double setup_seconds, double share,
                       Progress& progress)
    : scene_(scene), setup_seconds_(setup_seconds), slowness_(measured_slowness()) {
  const Scene coarse = at_pilot_quality(scene);
  const RunOptions options;
  Simulation pilot(coarse, options, simulation.world_state(), simulation.state());
  const long steps = static_cast<long>(last_frame(scene) - scene.start_frame) * pilot.steps_per_frame();
  double spent = 0;
  // What takes long from its beginning is worth the whole pilot.
  const auto enough = [&] {
    return spent >= most_seconds || (spent >= share * at(scene.quality, 1).processor_seconds &&
                                     static_cast<double>(rigid_.size()) >= 0.3 * static_cast<double>(steps));
  };
  while (static_cast<long>(rigid_.size()) < steps && !enough()) {
    progress.checkpoint("forecast", static_cast<double>(rigid_.size()) / static_cast<double>(steps));
    spent += follow(pilot, progress);
  }
  sum_up(pilot, steps);
}

/// One step of the pilot; returns its processor time [s].
double Forecaster::follow(Simulation& pilot, Progress& progress) {
  const auto& fractures = pilot.report().fractures;
  const std::size_t solved = fractures.size();
  const double start = cpu_seconds();
  pilot.step(progress);
  const double seconds = cpu_seconds() - start;
  // A step that breaks something is repeated; what it takes without the solves is that of the step before.
  rigid_.push_back(fractures.size() == solved ? seconds : rigid_.empty() ? 0 : rigid_.back());
  for (std::size_t n = solved; n < fractures.size(); ++n) {
    particles_ += static_cast<double>(fractures[n].particles);
    particle_steps_ += static_cast<double>(fractures[n].particles * fractures[n].steps);
  }
  solves_ = static_cast<int>(fractures.size());
  return seconds;
}

/// From the pilot to the whole scene: most bodies break early, so solves go on at the mean of the pilot, and at most
/// half as many again.
void Forecaster::sum_up(Simulation& pilot, long steps) {
  rigid_seconds_ = extrapolated(rigid_, steps);
  const double rest =
      std::min(1.5, static_cast<double>(steps) / std::max<double>(1, static_cast<double>(rigid_.size())));
  particles_ *= rest;
  particle_steps_ *= rest;
  for (const output::Piece& piece : pilot.sequence().pieces) {
    ever_.add(piece);
    if (piece.parent >= 0) ++fragments_;
    if (std::isinf(piece.death_time)) last_.add(piece);
  }
}

void Forecaster::Faces::add(const output::Piece& piece) {
  const auto cracks = std::count(piece.source_face.begin(), piece.source_face.end(), -1);
  outside += static_cast<double>(piece.mesh.faces.size()) - static_cast<double>(cracks);
  on_cracks += static_cast<double>(cracks);
}

/// Edges on cracks are as long as particles are apart.
double Forecaster::Faces::at(const Quality& quality) const {
  return outside + on_cracks * std::pow(quality.particles / static_cast<double>(pilot_quality.particles), 2.0 / 3);
}

/// A solve of r times the particles has steps that are r^(1/3) times as short.
double Forecaster::solve_seconds(const Quality& quality) const {
  const double finer = static_cast<double>(quality.particles) / pilot_quality.particles;
  double step = fitted::particle_step;
  if (scene_.fracture.spline == mpm::Spline::cubic) step *= fitted::cubic;
  const Ask sides = scene_.effects.asked[Effect::two_velocity_fields];
  if (sides == Ask::on || (sides == Ask::automatic && quality.particles >= Quality::final.particles))
    step *= fitted::two_fields;
  return finer * (std::cbrt(finer) * particle_steps_ * step + particles_ * fitted::particle_break);
}

double Forecaster::write_seconds(const Quality& quality) const {
  const int frames = last_frame(scene_) - scene_.start_frame + 1;
  return (scene_.outputs.poster ? fitted::poster : 0) +
         (scene_.outputs.obj ? fitted::face_frame * last_.at(quality) * frames : 0);
}

Prediction Forecaster::at(const Quality& quality, int threads) const {
  Prediction p;
  p.solves = solves_;
  const double pieces = solves_ > 0 ? fitted::finer_pieces : 1;
  const double rigid = rigid_seconds_ * pieces * quality.rigid_rate / pilot_quality.rigid_rate;
  p.processor_seconds =
      slowness_ * (fitted::start + solve_seconds(quality) + write_seconds(quality)) + setup_seconds_ + rigid;
  p.seconds = p.processor_seconds * (fitted::serial_share + (1 - fitted::serial_share) / threads_of(threads));
  p.memory_mb = fitted::program_mb + fitted::face_mb * ever_.at(quality) + fitted::fragment_mb * pieces * fragments_;
  if (solves_ > 0) p.memory_mb += fitted::particle_mb * quality.particles;
  return p;
}

Quality Forecaster::within(double seconds, int threads) const {
  Quality best = Quality::of(Quality::least_particles);
  for (double particles = Quality::least_particles; particles <= Quality::most_particles; particles *= 1.2) {
    const Quality quality = Quality::of(static_cast<int>(particles));
    if (at(quality, threads).seconds > seconds) break;
    best = quality;
  }
  return best;
}

Quality affordable_quality(const Scene& scene, const RunOptions& options, Progress& progress) {
  const double start = cpu_seconds();
  const Simulation simulation(scene, options, progress);
  return Forecaster(scene, simulation, cpu_seconds() - start, Forecaster::whole, progress)
      .within(*scene.time_budget, options.threads);
}

}  // namespace sunder::pipeline
