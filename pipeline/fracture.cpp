#include "pipeline/fracture.h"

#include <cmath>
#include <exception>

#include <Eigen/Cholesky>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include "core/stopwatch.h"
#include "geometry/mass_properties.h"
#include "geometry/sample.h"
#include "pipeline/handover.h"
#include "pipeline/joint_progress.h"

namespace sunder::pipeline {
namespace {

mpm::Material solid(const Material& m) {
  return {m.density, m.youngs_modulus, m.poisson_ratio, m.tensile_strength, m.fracture_energy, m.weibull_modulus};
}

/// The surface under a contact that collision hulls reported: the outermost sample near the axis, and half a spacing
/// further out.
Vec3 surface_point(const geometry::Samples& samples, const mpm::Load& load) {
  const double reach = 3 * samples.spacing;
  double highest = -std::numeric_limits<double>::infinity(), nearest = std::numeric_limits<double>::infinity();
  Vec3 nearest_point = load.point;
  for (const Vec3& x : samples.points) {
    const Vec3 r = x - load.point;
    const double height = r.dot(load.outward), off_axis = (r - height * load.outward).norm();
    if (off_axis < reach && std::abs(height) < 2 * reach) highest = std::max(highest, height);
    if (r.norm() < nearest) {
      nearest = r.norm();
      nearest_point = x;
    }
  }
  if (std::isinf(highest)) return nearest_point + 0.5 * samples.spacing * load.outward;
  return load.point + (highest + 0.5 * samples.spacing) * load.outward;
}

crack::DamageField damage_field(const geometry::Samples& samples, const mpm::SolveResult& solve) {
  crack::DamageField field{samples.points, {}, {}, samples.spacing, solve.cell_size};
  for (const mpm::ParticleState& p : solve.particles) {
    field.damage.push_back(p.damage);
    field.damage_time.push_back(p.damage_time);
  }
  return field;
}

/// Mean motion of the particles of each region: their momentum over their mass properties.
std::vector<Twist> region_motion(const geometry::Samples& samples, const mpm::SolveResult& solve,
                                 const std::vector<int>& region, int region_count, std::vector<Vec3>& centre) {
  const std::size_t count = static_cast<std::size_t>(region_count);
  std::vector<Vec3> linear(count, Vec3::Zero()), angular(count, Vec3::Zero());
  std::vector<Mat3> inertia(count, Mat3::Zero());
  std::vector<double> mass(count, 0.0);
  centre.assign(count, Vec3::Zero());
  const auto of = [&](std::size_t p) { return static_cast<std::size_t>(region[p]); };
  const double m = solve.particle_mass;
  for (std::size_t p = 0; p < region.size(); ++p) {
    centre[of(p)] += m * samples.points[p];
    mass[of(p)] += m;
  }
  for (std::size_t k = 0; k < count; ++k)
    if (mass[k] > 0) centre[k] /= mass[k];
  for (std::size_t p = 0; p < region.size(); ++p) {
    const Vec3 r = samples.points[p] - centre[of(p)];
    const mpm::ParticleState& s = solve.particles[p];
    linear[of(p)] += m * s.velocity;
    angular[of(p)] += m * r.cross(s.velocity) + s.spin_momentum;
    // The particle's own extent keeps the inertia of a single row of particles regular.
    const double own = m * samples.spacing * samples.spacing / 6;
    inertia[of(p)] += m * (r.squaredNorm() * Mat3::Identity() - r * r.transpose()) + own * Mat3::Identity();
  }
  std::vector<Twist> twists(count);
  for (std::size_t k = 0; k < count; ++k)
    if (mass[k] > 0) twists[k] = {linear[k] / mass[k], inertia[k].ldlt().solve(angular[k])};
  return twists;
}

/// Those of one region.
Particles particles_of(const Particles& all, const std::vector<int>& region, int wanted) {
  Particles kept{{{}, all.samples.spacing}, {}};
  std::vector<int> number(region.size(), -1);
  for (std::size_t p = 0; p < region.size(); ++p) {
    if (region[p] != wanted) continue;
    number[p] = static_cast<int>(kept.samples.points.size());
    kept.samples.points.push_back(all.samples.points[p]);
    kept.damage.damage.push_back(all.damage.damage[p]);
  }
  for (const auto& front : all.damage.fronts)
    if (const int n = number[static_cast<std::size_t>(front.particle)]; n >= 0)
      kept.damage.fronts.push_back({n, front.normal});
  return kept;
}

}  // namespace

FractureOutcome fracture(const FractureInput& input, Progress& progress) {
  FractureOutcome outcome;
  Particles particles;
  if (input.own) {
    particles = *input.own;
  } else {
    const Stopwatch watch(outcome.seconds.sample);
    particles.samples = geometry::sample_solid(input.mesh, {.count = input.particles, .seed = input.seed}, progress);
  }
  const geometry::Samples& samples = particles.samples;
  auto loads = input.loads;
  for (mpm::Load& load : loads) load.point = surface_point(samples, load);
  const double volume = geometry::mass_properties(input.mesh).volume;
  {
    const Stopwatch watch(outcome.seconds.solve);
    outcome.solve = mpm::solve({samples.points, volume, solid(input.material), loads, input.partners, {}, {}},
                               input.solve, progress);
  }
  outcome.particles = static_cast<long>(samples.points.size());
  if (outcome.solve.crushed_resets > 0)
    outcome.fallbacks["crushed_particles_reset"] += static_cast<int>(outcome.solve.crushed_resets);
  outcome.damaged_share = outcome.solve.damaged_share;
  outcome.own = std::make_shared<Particles>(Particles{samples, outcome.solve.cracks});
  if (outcome.solve.failures == 0) return outcome;

  outcome.cracked = crack_and_cut(input.mesh, damage_field(samples, outcome.solve), input.crack, input.seed, progress);
  const Cracked& cracked = outcome.cracked;
  outcome.seconds.extract = cracked.extract_seconds;
  outcome.seconds.cut = cracked.cut_seconds;
  for (const auto& [name, count] : cracked.fallbacks) outcome.fallbacks[name] += count;
  if (cracked.cut.fragments.size() < 2) return outcome;
  std::vector<Vec3> centre;
  const std::vector<int>& region = cracked.extraction.region;
  const auto motion = region_motion(samples, outcome.solve, region, cracked.extraction.region_count, centre);
  for (const geometry::Fragment& fragment : cracked.cut.fragments) {
    const std::size_t k = static_cast<std::size_t>(fragment.region);
    const geometry::MassProperties whole = geometry::mass_properties(fragment.mesh);
    BrokenPiece piece{fragment, {motion[k].at(whole.centroid - centre[k]), motion[k].angular}, nullptr};
    if (whole.volume >= input.nearly_whole * volume)
      piece.own = std::make_shared<Particles>(particles_of(*outcome.own, region, fragment.region));
    outcome.pieces.push_back(std::move(piece));
  }
  return outcome;
}

std::vector<FractureOutcome> fracture_all(const std::vector<FractureInput>& inputs, Progress& progress) {
  std::vector<FractureOutcome> outcomes(inputs.size());
  if (inputs.size() == 1) outcomes[0] = fracture(inputs[0], progress);
  if (inputs.size() < 2) return outcomes;
  JointProgress joint(progress, inputs.size());
  std::vector<std::exception_ptr> failures(inputs.size());
  tbb::parallel_for(std::size_t{0}, inputs.size(), [&](std::size_t i) {
    // While it waits for its own parts, a solve must not begin with another one.
    tbb::this_task_arena::isolate([&] {
      try {
        outcomes[i] = fracture(inputs[i], joint.part(i));
      } catch (...) {
        failures[i] = std::current_exception();
      }
    });
  });
  for (const std::exception_ptr& failure : failures)
    if (failure) std::rethrow_exception(failure);
  return outcomes;
}

}  // namespace sunder::pipeline
