#include "pipeline/accuracy.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include <unistd.h>

#include "core/resources.h"
#include "output/atomic_file.h"
#include "pipeline/detail/accuracy_report.h"
#include "pipeline/scene.h"
#include "pipeline/simulation.h"

namespace sunder::pipeline {
namespace {

using detail::HitStudy;
using detail::Rung;
using detail::Variant;

constexpr int coarsest = 5000;

std::vector<int> ladder(int most) {
  std::vector<int> particles;
  for (int n = coarsest; n <= most; n *= 2) particles.push_back(n);
  if (particles.size() < 3)
    throw Error(ErrorKind::usage, "--particles: a ladder needs three rungs from " + std::to_string(coarsest) +
                                      " on: at least " + std::to_string(4 * coarsest));
  return particles;
}

FractureInput at_rung(FractureInput input, const Rung& rung) {
  input.particles = rung.particles;
  input.own = nullptr;
  input.solve.two_fields = rung.variant == Variant::two_fields;
  input.solve.spline = rung.variant == Variant::cubic ? mpm::Spline::cubic : mpm::Spline::quadratic;
  input.solve.energy_ledger = true;
  input.crack.detail.clear();
  input.crack.hairline_width = 0;
  // Seeds of the rungs differ from each other as two runs of the scene do.
  input.seed = input.solve.seed = input.seed + static_cast<std::uint64_t>(rung.seed - 1);
  return input;
}

/// Which rungs there are, the finest first: it is what the others are compared with.
std::vector<Rung> rungs_of(const std::vector<int>& particles, int seeds) {
  std::vector<Rung> rungs;
  for (std::size_t n = particles.size(); n-- > 0;) {
    const bool cheap = n + 2 < particles.size();
    for (int seed = 1; seed <= (cheap ? seeds : 1); ++seed) rungs.push_back({particles[n], Variant::plain, seed});
    if (!cheap) continue;
    rungs.push_back({particles[n], Variant::cubic, 1});
    rungs.push_back({particles[n], Variant::two_fields, 1});
  }
  return rungs;
}

void solve(const FractureInput& input, Rung& rung, Progress& progress) {
  restart_peak_memory();
  const double start = cpu_seconds();
  const FractureOutcome outcome = fracture(at_rung(input, rung), progress);
  rung.processor_seconds = cpu_seconds() - start;
  rung.memory_mb = peak_memory_mb();
  rung.steps = outcome.solve.steps;
  rung.fragments = static_cast<int>(std::max<std::size_t>(1, outcome.pieces.size()));
  rung.effective_count = outcome.cracked.extraction.effective_count;
  rung.damaged_share = outcome.damaged_share;
  rung.trace = trace_of(input, outcome);
}

void print_head() {
  std::printf("%9s %-10s %4s %8s %7s %7s %6s %7s %9s %9s %9s %9s %9s\n", "particles", "variant", "seed", "cpu [s]",
              "MB", "pieces", "eff.", "damage", "crack", "hausd.", "volumes", "area", "force");
}

std::string dash(const std::optional<double>& x) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4f", x.value_or(0));
  return x ? text : "-";
}

void print(const Rung& r, const FractureTrace& finest) {
  if (isatty(STDERR_FILENO)) std::fputs("\r\x1b[K", stdout);
  std::printf("%9d %-10s %4d %8.2f %7.0f %7d %6.1f %7.3f %9s %9s %9.4f %9.3f %9.3f\n", r.particles,
              detail::name_of(r.variant), r.seed, r.processor_seconds, r.memory_mb, r.fragments, r.effective_count,
              r.to_finest.damage, dash(r.to_finest.crack_mean).c_str(), dash(r.to_finest.crack_hausdorff).c_str(),
              r.to_finest.volumes, finest.crack_area > 0 ? r.trace.crack_area / finest.crack_area : 0.0,
              finest.peak_force > 0 ? r.trace.peak_force / finest.peak_force : 0.0);
  std::fflush(stdout);
}

/// Stops between rungs when the user asked to.
HitStudy study(const RehearsedHit& hit, std::vector<Rung> rungs, Progress& progress) {
  HitStudy result;
  result.body = hit.body;
  result.time = hit.time;
  result.severity = hit.severity;
  std::printf("%s, hit at %.4f s\n", hit.body.c_str(), hit.time);
  print_head();
  for (std::size_t n = 0; n < rungs.size(); ++n) {
    progress.report("total", static_cast<double>(n) / static_cast<double>(rungs.size()));
    try {
      solve(hit.input, rungs[n], progress);
    } catch (const Error& error) {
      if (error.kind() == ErrorKind::interrupted) break;
      throw;
    }
    result.rungs.push_back(rungs[n]);
    Rung& rung = result.rungs.back();
    rung.to_finest = distance(rung.trace, result.rungs.front().trace);
    print(rung, result.rungs.front().trace);
  }
  return result;
}

}  // namespace

void measure_accuracy(const AccuracyOptions& options, Progress& progress) {
  const std::vector<Rung> rungs = rungs_of(ladder(options.most_particles), options.seeds);
  const Scene scene = load_scene(options.scene);
  output::create_folder(options.out);
  output::require_writable(options.out);
  const RunOptions run_options;
  Simulation simulation(scene, run_options, progress);
  const auto hits = simulation.rehearse(options.hits, progress);
  if (hits.empty())
    throw Error(ErrorKind::usage,
                options.scene.string() + ": nothing in this scene is hit so hard that it would break");
  std::vector<HitStudy> studies;
  for (const RehearsedHit& hit : hits) {
    studies.push_back(study(hit, rungs, progress));
    if (progress.cancelled()) break;
  }
  std::erase_if(studies, [](const HitStudy& s) { return s.rungs.size() < 2; });
  if (!studies.empty()) {
    for (const HitStudy& s : studies)
      for (const std::string& sentence : detail::findings(s)) std::printf("%s\n", sentence.c_str());
    detail::write_accuracy(scene.name, studies, options.out);
  }
  if (progress.cancelled()) throw Error(ErrorKind::interrupted, "interrupted");
}

}  // namespace sunder::pipeline
