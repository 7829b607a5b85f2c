#include "mpm/solve.h"

#include <atomic>
#include <cmath>
#include <string>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "mpm/contact_load.h"
#include "mpm/front.h"
#include "mpm/grid.h"
#include "mpm/neo_hookean.h"
#include "mpm/quadratic_kernel.h"
#include "mpm/rankine.h"
#include "mpm/strength_scatter.h"
#include "mpm/transfer.h"

namespace sunder::mpm {
namespace {

constexpr double cracked = 0.95;
/// Beyond these the neo-Hookean law says nothing about a solid any more: the particle is debris.
constexpr double least_volume_change = -0.5, most_volume_change = 2, most_stretch = 6;
constexpr std::size_t chunk = 512;

void require(bool holds, const std::string& what) {
  if (!holds) throw Error(ErrorKind::usage, what);
}

bool positive(double x) { return x > 0 && std::isfinite(x); }

void check(const std::vector<Vec3>& points, double volume, const Material& m, const std::vector<Load>& loads,
           const std::vector<Partner>& partners, const SolveSettings& settings) {
  require(!points.empty() && positive(volume), "a solve needs points and a positive volume");
  for (const Vec3& x : points) require(x.allFinite(), "a point is not finite");
  require(
      positive(m.density) && positive(m.youngs_modulus) && positive(m.tensile_strength) && positive(m.fracture_energy),
      "density, Young's modulus, tensile strength and fracture energy must be positive");
  require(m.poisson_ratio > -1 && m.poisson_ratio < 0.5, "Poisson's ratio must lie in (-1, 0.5)");
  require(settings.cfl > 0 && settings.cfl <= 1, "cfl must lie in (0, 1]: beyond 1 the explicit step is unstable");
  require(!loads.empty(), "a solve needs a load");
  for (const Load& load : loads) {
    require(load.point.allFinite() && std::abs(load.outward.norm() - 1) < 1e-6, "outward must be a unit vector");
    require(positive(load.approach_speed), "approach_speed must be positive");
    require(positive(load.pair.effective_radius), "effective_radius must be positive");
    require(positive(load.pair.effective_modulus), "effective_modulus must be positive");
    require(load.pair.contact_pressure > 0, "contact_pressure must be positive");
    require(load.partner >= 0 && load.partner < static_cast<int>(partners.size()),
            "a load names a partner that is not there");
    require(partners[static_cast<std::size_t>(load.partner)].mass > 0, "a partner's mass must be positive");
  }
}

Box box_of(const std::vector<Particle>& particles, bool material) {
  Box box;
  for (const Particle& p : particles)
    if (material || !p.escaped) box.extend(material ? p.material_position : p.position());
  return box;
}

/// Kinetic energy of the body and its partners in the frame of their common centre of mass, or in that of the fastest
/// partner of infinite mass: what the contacts can at most turn into deformation. One partner: 1/2 m_s v^2.
double impact_energy(double body_mass, const std::vector<Load>& loads, const std::vector<Partner>& partners) {
  std::vector<Vec3> velocity(partners.size(), Vec3::Zero());
  for (const Load& load : loads) {
    Vec3& v = velocity[static_cast<std::size_t>(load.partner)];
    if (load.approach_speed > v.norm()) v = -load.approach_speed * load.outward;
  }
  double mass = body_mass;
  Vec3 moment = Vec3::Zero(), wall = Vec3::Zero();
  bool has_wall = false;
  for (std::size_t p = 0; p < partners.size(); ++p) {
    if (std::isinf(partners[p].mass)) {
      has_wall = true;
      if (velocity[p].norm() > wall.norm()) wall = velocity[p];
    } else {
      mass += partners[p].mass;
      moment += partners[p].mass * velocity[p];
    }
  }
  const Vec3 frame = has_wall ? wall : Vec3(moment / mass);
  double energy = 0.5 * body_mass * frame.squaredNorm();
  for (std::size_t p = 0; p < partners.size(); ++p)
    if (std::isfinite(partners[p].mass)) energy += 0.5 * partners[p].mass * (velocity[p] - frame).squaredNorm();
  return energy;
}

/// Motion of a partner relative to its undisturbed flight.
struct PartnerMotion {
  Vec3 displacement = Vec3::Zero(), velocity = Vec3::Zero();
};

class Solver {
 public:
  Solver(const std::vector<Vec3>& points, double volume, const Material& material, const std::vector<Load>& loads,
         const std::vector<Partner>& partners, const SolveSettings& settings);

  void step();
  bool finished() const;
  double fraction() const { return std::min(1.0, time_ / latest_end_); }
  SolveResult result() const;

 private:
  void place_particles(const std::vector<Vec3>& points);
  void set_strengths(const std::vector<Vec3>& points);
  void sort_particles();
  void update_stress();
  void update_particle(Particle& p, std::vector<Candidate>& candidates);
  void soften(Particle& p, const PrincipalStress& stress) const;
  void start_cracks();
  void start_crack(Particle& p, Verdict verdict, const Candidate& candidate);
  void push();
  void book_work();
  void require_finite() const;

  const Material material_;
  const SolveSettings settings_;
  const std::vector<Partner> partners_;
  const NeoHookean elasticity_;
  double particle_volume_, particle_mass_, body_mass_, cell_size_, wave_speed_, time_step_, transit_, viscosity_;
  Softening propagation_;
  std::vector<Particle> particles_;
  Box followed_;  ///< where the grid follows particles, about the centre of mass
  Grid grid_;
  SlabOrder slabs_;
  bool in_place_ = false;
  CrackFronts fronts_;
  std::vector<ContactLoad> loads_;
  std::vector<PartnerMotion> partner_motion_;
  std::vector<std::vector<Candidate>> candidates_;  ///< by chunk of particles
  std::atomic<bool> failure_ = false, lost_ = false;
  std::atomic<long> resets_ = 0;
  Vec3 impulse_ = Vec3::Zero(), travel_ = Vec3::Zero();  ///< of the body as a whole
  double time_ = 0, last_failure_ = 0, contact_duration_ = 0, latest_end_ = 0, work_ = 0, impact_energy_ = 0;
  long steps_ = 0, nuclei_ = 0;
};

Box points_box(const std::vector<Vec3>& points) {
  Box box;
  for (const Vec3& x : points) box.extend(x);
  return box;
}

Softening propagation_law(const Material& m, const SolveSettings& settings, double cell_size) {
  const double band = settings.band_width * cell_size;
  const double k = settings.damage == DamageModel::front ? settings.front.energy_factor : 1;
  return make_softening(m.youngs_modulus, m.tensile_strength, k * m.fracture_energy, band, CoarseGrid::lower_strength);
}

Solver::Solver(const std::vector<Vec3>& points, double volume, const Material& material, const std::vector<Load>& loads,
               const std::vector<Partner>& partners, const SolveSettings& settings)
    : material_(material),
      settings_(settings),
      partners_(partners),
      elasticity_(material),
      particle_volume_(volume / static_cast<double>(points.size())),
      particle_mass_(material.density * particle_volume_),
      body_mass_(material.density * volume),
      cell_size_(std::cbrt(particle_volume_) / settings.cells_per_spacing),
      wave_speed_(material.p_wave_speed()),
      time_step_(settings.cfl * cell_size_ / wave_speed_),
      transit_(points_box(points).sizes().maxCoeff() / wave_speed_),
      viscosity_(settings.viscosity * material.density * wave_speed_ * cell_size_),
      propagation_(propagation_law(material, settings, cell_size_)),
      grid_(points_box(points), cell_size_, 4, points_box(points).min()),
      fronts_(points_box(points), cell_size_, wave_speed_, settings.front) {
  place_particles(points);
  set_strengths(points);
  followed_ = points_box(points);
  const Vec3 room = Vec3::Constant(0.5 * followed_.diagonal().norm() + 4 * cell_size_);
  followed_ = Box(followed_.min() - room, followed_.max() + room);
  candidates_.resize((points.size() + chunk - 1) / chunk);
  partner_motion_.resize(partners.size());
  impact_energy_ = impact_energy(body_mass_, loads, partners);
  for (const Load& load : loads) {
    const Partner& partner = partners[static_cast<std::size_t>(load.partner)];
    const double m = reduced_mass(body_mass_, partner.mass);
    loads_.emplace_back(load, body_mass_, partner, material, cell_size_, settings, particles_);
    contact_duration_ = std::max(contact_duration_, impact_duration(m, load.approach_speed, load.pair));
    if (std::isfinite(partner.mass)) {
      const double stiffness = 2 * load.pair.effective_modulus * settings.smallest_patch * cell_size_;
      time_step_ = std::min(time_step_, 0.5 * std::sqrt(partner.mass / stiffness));
    }
  }
  latest_end_ = contact_duration_ + settings.most_transits * transit_;
}

/// Stored cell by cell, so that neighbours in space are neighbours in memory.
void Solver::place_particles(const std::vector<Vec3>& points) {
  particles_.resize(points.size());
  for (std::size_t p = 0; p < points.size(); ++p) {
    particles_[p].id = static_cast<int>(p);
    particles_[p].material_position = points[p];
  }
  const SlabOrder slabs = slab_order(particles_, grid_);
  std::vector<Particle> sorted;
  sorted.reserve(points.size());
  for (int p : slabs.order) sorted.push_back(particles_[static_cast<std::size_t>(p)]);
  particles_ = std::move(sorted);
}

void Solver::set_strengths(const std::vector<Vec3>& points) {
  const auto factor =
      strength_scatter(points, material_.weibull_modulus, settings_.scatter_length * cell_size_, settings_.seed);
  for (Particle& p : particles_) {
    const double f = factor[static_cast<std::size_t>(p.id)];
    p.nucleation_strength = f * material_.tensile_strength;
    p.softening_slope = propagation_.slope;
    if (settings_.damage == DamageModel::local) {
      p.role = CrackRole::front;
      // Scatter beyond what the softening law can carry at this energy would make its slope negative.
      p.strength = std::min(f * propagation_.strength,
                            propagation_.strength * std::sqrt((1 + propagation_.slope) / propagation_.slope / 1.02));
      const double ratio =
          propagation_.slope / (1 + propagation_.slope) * std::pow(p.strength / propagation_.strength, 2);
      p.softening_slope = ratio / (1 - ratio);
      p.threshold = p.strength;
    } else {
      p.threshold = std::min(p.nucleation_strength, propagation_.strength);
    }
  }
}

/// Particles that flew beyond the followed box go on without the grid.
void Solver::sort_particles() {
  bool escape = false;
  for (Particle& p : particles_)
    if (!p.escaped && !followed_.contains(p.position() - travel_)) {
      p.escaped = escape = true;
      p.damage = 1;
      if (p.damage_time < 0) p.damage_time = time_;
    }
  if (escape) {
    require_finite();  // what is not a number is nowhere either
    for (ContactLoad& load : loads_) load.drop_escaped(particles_);
  }
  if (const Box box = box_of(particles_, false); !box.isEmpty()) grid_ = Grid(box, cell_size_, 4, grid_.origin());
  slabs_ = slab_order(particles_, grid_);
}

void Solver::soften(Particle& p, const PrincipalStress& stress) const {
  const double largest = stress.value[2];
  if (p.role == CrackRole::virgin || largest <= p.threshold) return;
  const double before = p.threshold;
  p.threshold = largest;
  const double damage = Softening{p.strength, p.softening_slope, 0}.damage(largest);
  if (damage <= p.damage) return;
  // Dissipation density is the integral of the driving energy r^2 / 2E over dc.
  p.dissipated += (damage - p.damage) * 0.25 * (before * before + largest * largest) / material_.youngs_modulus;
  p.damage = damage;
}

void Solver::update_particle(Particle& p, std::vector<Candidate>& candidates) {
  Mat3& h = p.displacement_gradient;
  double dj = volume_change(h);
  if (!std::isfinite(dj)) {
    lost_.store(true, std::memory_order_relaxed);
    return;
  }
  const double stretch = 2 * h.trace() + h.squaredNorm();
  if (dj < least_volume_change || dj > most_volume_change || stretch > most_stretch) {
    h.setZero();
    dj = 0;
    p.damage = 1;
    p.role = p.role == CrackRole::virgin ? CrackRole::filler : p.role;
    resets_.fetch_add(1, std::memory_order_relaxed);
  }
  Mat3 stress = elasticity_.cauchy_stress(h, dj);
  if (p.damage > 0 || principal_stress_bound(stress) > p.threshold) {
    const PrincipalStress principal = principal_stress(stress);
    if (p.role == CrackRole::virgin && principal.value[2] > p.threshold)
      candidates.push_back({p.id, p.material_position, principal.direction.col(2), principal.value[2],
                            principal.value[2] / p.nucleation_strength});
    soften(p, principal);
    if (p.damage > 0) stress = damaged_stress(principal, p.damage);
  }
  if (p.damage >= 0.99 && p.damage_time < 0) {
    p.damage_time = time_;
    failure_.store(true, std::memory_order_relaxed);
  }
  stress += 0.5 * viscosity_ * (1 - p.damage) * (p.affine_velocity + p.affine_velocity.transpose());
  const double factor = time_step_ * particle_volume_ / (quadratic_moment * cell_size_ * cell_size_) * (1 + dj);
  p.affine_momentum = particle_mass_ * p.affine_velocity - factor * stress;
}

void Solver::update_stress() {
  failure_ = false;
  tbb::parallel_for(std::size_t{0}, candidates_.size(), [&](std::size_t c) {
    candidates_[c].clear();
    for (std::size_t n = c * chunk; n < std::min((c + 1) * chunk, particles_.size()); ++n) {
      if (particles_[n].escaped) continue;
      const std::size_t before = candidates_[c].size();
      update_particle(particles_[n], candidates_[c]);
      if (candidates_[c].size() > before) candidates_[c].back().particle = static_cast<int>(n);
    }
  });
  if (lost_) require_finite();
  if (failure_) last_failure_ = time_;
}

void Solver::start_crack(Particle& p, Verdict verdict, const Candidate& candidate) {
  p.role = verdict == Verdict::filler ? CrackRole::filler : CrackRole::front;
  p.strength = p.threshold = propagation_.strength;
  p.softening_slope = propagation_.slope;
  if (verdict == Verdict::nucleate) ++nuclei_;
  if (p.role == CrackRole::front) fronts_.add(candidate.position, candidate.normal, time_);
}

/// Strongest first, ties by index. What the fronts of earlier steps say is asked in parallel; only fronts of this step
/// are asked in order.
void Solver::start_cracks() {
  std::vector<Candidate> all;
  for (const auto& part : candidates_) all.insert(all.end(), part.begin(), part.end());
  if (all.empty()) return;
  std::sort(all.begin(), all.end(), [](const Candidate& a, const Candidate& b) {
    return a.urgency > b.urgency || (a.urgency == b.urgency && a.particle < b.particle);
  });
  std::vector<CrackFronts::Sight> sights(all.size());
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, all.size(), 16), [&](const auto& range) {
    for (std::size_t n = range.begin(); n < range.end(); ++n)
      sights[n] = fronts_.look(all[n].position, all[n].normal, time_);
  });
  const int known = fronts_.count();
  for (std::size_t n = 0; n < all.size(); ++n) {
    const Candidate& c = all[n];
    const auto sight =
        fronts_.count() > known ? sights[n] | fronts_.look(c.position, c.normal, time_, known) : sights[n];
    const Verdict verdict = sight.verdict();
    Particle& p = particles_[static_cast<std::size_t>(c.particle)];
    const double strength = verdict == Verdict::nucleate ? p.nucleation_strength : propagation_.strength;
    if (verdict != Verdict::wait && c.stress > strength) start_crack(p, verdict, c);
  }
}

void Solver::push() {
  for (ContactLoad& load : loads_) {
    const std::size_t partner = static_cast<std::size_t>(load.load().partner);
    PartnerMotion& motion = partner_motion_[partner];
    const Vec3 impulse = load.apply(particles_, time_step_, grid_);
    impulse_ -= impulse;
    if (std::isfinite(partners_[partner].mass)) motion.velocity += impulse / partners_[partner].mass;
  }
  for (PartnerMotion& motion : partner_motion_) motion.displacement += time_step_ * motion.velocity;
  travel_ += time_step_ / body_mass_ * impulse_;
}

/// Work of the loads less the energy of the body's translation.
void Solver::book_work() {
  double work = -0.5 * impulse_.squaredNorm() / body_mass_;
  for (const ContactLoad& load : loads_) work += load.work();
  work_ = std::max(work_, work);
}

void Solver::step() {
  if (!in_place_) sort_particles();
  grid_.clear();
  update_stress();
  if (settings_.damage == DamageModel::front) start_cracks();
  for (ContactLoad& load : loads_)
    load.evaluate(particles_, partner_motion_[static_cast<std::size_t>(load.load().partner)].displacement, time_,
                  time_step_);
  book_work();
  particle_to_grid(particles_, slabs_, particle_mass_, grid_);
  push();
  grid_.momentum_to_velocity();
  in_place_ = grid_to_particle(grid_, slabs_, time_step_, particles_);
  for (Particle& p : particles_)
    if (p.escaped) p.displacement += time_step_ * p.velocity;
  time_ += time_step_;
  ++steps_;
}

bool Solver::finished() const {
  if (time_ < contact_duration_) return false;
  return time_ - last_failure_ >= settings_.quiet_transits * transit_ || time_ >= latest_end_;
}

void Solver::require_finite() const {
  for (const Particle& p : particles_)
    if (!p.displacement_gradient.allFinite() || !p.velocity.allFinite())
      throw Error(ErrorKind::unstable, "the solve lost particle " + std::to_string(p.id) + " in step " +
                                           std::to_string(steps_) +
                                           ": its state is not finite; lower the time step (cfl)");
}

SolveResult Solver::result() const {
  require_finite();
  SolveResult r;
  r.particles.resize(particles_.size());
  const double moment = particle_mass_ * quadratic_moment * cell_size_ * cell_size_;
  std::vector<double> dissipated(particles_.size());
  for (const Particle& p : particles_) {
    const Mat3& c = p.affine_velocity;
    const Vec3 spin(c(2, 1) - c(1, 2), c(0, 2) - c(2, 0), c(1, 0) - c(0, 1));
    r.particles[static_cast<std::size_t>(p.id)] = {p.displacement, p.velocity, moment * spin, p.damage, p.damage_time};
    dissipated[static_cast<std::size_t>(p.id)] = p.dissipated * particle_volume_;
    r.damaged_share += p.damage >= cracked;
  }
  r.damaged_share /= static_cast<double>(particles_.size());
  for (double d : dissipated) r.dissipated += d;
  for (const ContactLoad& load : loads_) r.loads.push_back(load.result());
  r.cell_size = cell_size_;
  r.time_step = time_step_;
  r.duration = time_;
  r.steps = steps_;
  r.particle_mass = particle_mass_;
  r.work = work_;
  r.impact_energy = impact_energy_;
  r.nuclei = nuclei_;
  r.crushed_resets = resets_;
  r.band_width = settings_.band_width * cell_size_;
  r.admissible_length =
      admissible_length(material_.youngs_modulus, material_.tensile_strength, material_.fracture_energy);
  r.propagation_strength = propagation_.strength;
  return r;
}

}  // namespace

SolveResult solve(const std::vector<Vec3>& points, double volume, const Material& material,
                  const std::vector<Load>& loads, const std::vector<Partner>& partners, const SolveSettings& settings,
                  Progress& progress) {
  check(points, volume, material, loads, partners, settings);
  Solver solver(points, volume, material, loads, partners, settings);
  for (long n = 0; !solver.finished(); ++n) {
    if (n % 16 == 0) progress.checkpoint("solve", solver.fraction());
    solver.step();
  }
  return solver.result();
}

}  // namespace sunder::mpm
