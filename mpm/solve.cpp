#include "mpm/solve.h"

#include <cmath>
#include <optional>
#include <string>

#include "core/error.h"
#include "core/optional_effects.h"
#include "mpm/contact_load.h"
#include "mpm/crack_growth.h"
#include "mpm/rankine.h"

namespace sunder::mpm {
namespace {

constexpr double cracked = 0.95;
/// A front crosses two cells in so many steps.
constexpr long steps_between_openings = 16;

void require(bool holds, const std::string& what) {
  if (!holds) throw Error(ErrorKind::usage, what);
}

bool positive(double x) { return x > 0 && std::isfinite(x); }

void check(const SolveInput& input, const SolveSettings& settings) {
  const auto& [points, volume, m, loads, partners, held, prior] = input;
  require(!points.empty() && positive(volume), "a solve needs points and a positive volume");
  for (const Vec3& x : points) require(x.allFinite(), "a point is not finite");
  require(
      positive(m.density) && positive(m.youngs_modulus) && positive(m.tensile_strength) && positive(m.fracture_energy),
      "density, Young's modulus, tensile strength and fracture energy must be positive");
  require(m.poisson_ratio > -1 && m.poisson_ratio < 0.5, "Poisson's ratio must lie in (-1, 0.5)");
  require(settings.cfl > 0 && settings.cfl <= 1, "cfl must lie in (0, 1]: beyond 1 the explicit step is unstable");
  require(!loads.empty(), "a solve needs a load");
  require(prior.damage.empty() || prior.damage.size() == points.size(), "prior damage must name every point");
  for (const PriorDamage::Front& front : prior.fronts)
    require(front.particle >= 0 && static_cast<std::size_t>(front.particle) < points.size(),
            "a prior crack names a particle that is not there");
  for (const HeldRegion& region : held)
    require(!region.region.isEmpty() && region.velocity.allFinite(), "a held region must not be empty");
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

/// Numbers of a solve that follow from its input.
struct Scales {
  double particle_volume, cell_size, wave_speed, time_step, transit;

  Scales(const SolveInput& input, const SolveSettings& settings)
      : Scales(input, box_of(input.points), static_cast<long>(input.points.size()), settings) {}
  Scales(const SolveInput& input, const Box& box, long count, const SolveSettings& settings)
      : particle_volume(input.volume / static_cast<double>(count)),
        cell_size(std::cbrt(particle_volume) / settings.cells_per_spacing),
        wave_speed(input.material.p_wave_speed()),
        time_step(settings.cfl * cell_size / wave_speed),
        transit(box.sizes().maxCoeff() / wave_speed) {
    // A light partner on the stiff contact swings faster than waves cross a cell.
    for (const Load& load : input.loads) {
      const double mass = input.partners[static_cast<std::size_t>(load.partner)].mass;
      const double stiffness = 2 * load.pair.effective_modulus * settings.smallest_patch * cell_size;
      time_step = std::min(time_step, 0.5 * std::sqrt(mass / stiffness));
    }
  }
};

ContinuumSettings continuum_settings(const SolveInput& input, const SolveSettings& settings, const Scales& scales) {
  ContinuumSettings result;
  result.cell_size = scales.cell_size;
  result.time_step = scales.time_step;
  result.viscosity = settings.viscosity * input.material.density * scales.wave_speed * scales.cell_size;
  result.anchor = box_of(input.points).min();
  result.spline = settings.spline;
  result.books_energy = settings.energy_ledger;
  return result;
}

/// Of the longest contact of a body of this mass.
double contact_duration(const SolveInput& input, double body_mass) {
  double longest = 0;
  for (const Load& load : input.loads) {
    const double mass = reduced_mass(body_mass, input.partners[static_cast<std::size_t>(load.partner)].mass);
    longest = std::max(longest, impact_duration(mass, load.approach_speed, load.pair));
  }
  return longest;
}

class Solver {
 public:
  Solver(const SolveInput& input, const SolveSettings& settings);

  void advance();
  /// Nothing while it goes on.
  std::optional<StopReason> finished() const;
  double fraction() const { return std::min(1.0, time_ / latest_end_); }
  SolveResult result(StopReason stop);

 private:
  void step();
  void follow();
  void push();
  void open_cracks();
  void book_work();
  EnergyLedger ledger(const std::vector<Motion>& motion) const;

  const SolveInput& input_;
  const SolveSettings settings_;
  const Scales scales_;
  const double body_mass_;
  Continuum body_;
  CrackGrowth cracks_;
  std::vector<ContactLoad> loads_;
  std::vector<PartnerMotion> partner_motion_;
  Box room_;  ///< where particles are followed, about the centre of mass
  long escapes_ = 0;
  Vec3 impulse_ = Vec3::Zero(), travel_ = Vec3::Zero();  ///< of the body as a whole
  double time_ = 0, last_failure_ = 0, contact_duration_ = 0, latest_end_ = 0, work_ = 0, impact_energy_ = 0;
  long steps_ = 0;
  Effort two_field_steps_;
};

Solver::Solver(const SolveInput& input, const SolveSettings& settings)
    : input_(input),
      settings_(settings),
      scales_(input, settings),
      body_mass_(input.material.density * input.volume),
      body_(input.points, scales_.particle_volume, input.material, continuum_settings(input, settings, scales_)),
      cracks_(input.material, settings, input.points, body_),
      partner_motion_(input.partners.size()),
      impact_energy_(impact_energy(body_mass_, input.loads, input.partners)) {
  const Box box = box_of(input.points);
  const Vec3 margin = Vec3::Constant(0.5 * box.diagonal().norm() + 4 * scales_.cell_size);
  room_ = Box(box.min() - margin, box.max() + margin);
  body_.hold(input.held);
  cracks_.inherit(input.prior, body_);
  for (const Load& load : input.loads) {
    const Partner& partner = input.partners[static_cast<std::size_t>(load.partner)];
    loads_.emplace_back(load, body_mass_, partner, input.material, settings, body_);
  }
  contact_duration_ = contact_duration(input, body_mass_);
  latest_end_ = contact_duration_ + settings.most_transits * scales_.transit;
}

/// Keeps the followed box with the centre of mass; loads let go of what left it.
void Solver::follow() {
  body_.follow(Box(room_.min() + travel_, room_.max() + travel_));
  if (body_.escapes() == escapes_) return;
  escapes_ = body_.escapes();
  for (ContactLoad& load : loads_) load.drop_escaped(body_);
}

void Solver::push() {
  for (ContactLoad& load : loads_) {
    const std::size_t partner = static_cast<std::size_t>(load.load().partner);
    PartnerMotion& motion = partner_motion_[partner];
    const Vec3 impulse = load.apply(scales_.time_step, body_);
    impulse_ -= impulse;
    if (std::isfinite(input_.partners[partner].mass)) motion.velocity += impulse / input_.partners[partner].mass;
  }
  for (PartnerMotion& motion : partner_motion_) motion.displacement += scales_.time_step * motion.velocity;
  if (input_.held.empty()) travel_ += scales_.time_step / body_mass_ * impulse_;
}

void Solver::open_cracks() {
  if (with_optional_effects && settings_.two_fields && steps_ % steps_between_openings == 0)
    body_.open(cracks_.new_faces(body_), settings_.crack_friction);
}

/// Work of the loads less the energy of the body's translation, which a held body does not have.
void Solver::book_work() {
  double work = input_.held.empty() ? -0.5 * impulse_.squaredNorm() / body_mass_ : 0;
  for (const ContactLoad& load : loads_) work += load.work();
  work_ = std::max(work_, work);
}

void Solver::step() {
  body_.advance(time_);
  follow();
  if (body_.failed()) last_failure_ = time_;
  cracks_.grow(time_, body_);
  for (ContactLoad& load : loads_)
    load.evaluate(body_, partner_motion_[static_cast<std::size_t>(load.load().partner)].displacement, time_,
                  scales_.time_step);
  book_work();
  push();
  body_.update_grid();
  open_cracks();
  time_ += scales_.time_step;
  ++steps_;
}

void Solver::advance() {
  if (!with_optional_effects || !body_.divided()) return step();
  const Stopwatch watch(two_field_steps_.seconds);
  ++two_field_steps_.count;
  step();
}

std::optional<StopReason> Solver::finished() const {
  if (steps_ >= settings_.most_steps) return StopReason::steps;
  if (static_cast<double>(body_.failures()) >= settings_.most_damaged_share * body_.size()) return StopReason::damage;
  if (time_ < contact_duration_) return {};
  if (time_ - last_failure_ >= settings_.quiet_transits * scales_.transit) return StopReason::quiet;
  if (time_ >= latest_end_) return StopReason::time_limit;
  return {};
}

EnergyLedger Solver::ledger(const std::vector<Motion>& motion) const {
  const StoredEnergy stored = body_.energy(motion);
  EnergyLedger energy{0, stored.kinetic, stored.tension, stored.compression, 0, body_.viscous_work()};
  for (int id = 0; id < body_.size(); ++id) energy.fracture += body_.point(id).dissipated * scales_.particle_volume;
  for (const ContactLoad& load : loads_) energy.work += load.work();
  for (std::size_t n = 0; n < input_.held.size(); ++n)
    energy.work += body_.held_impulses()[n].dot(input_.held[n].velocity);
  return energy;
}

SolveResult Solver::result(StopReason stop) {
  const std::vector<Motion> motion = body_.finish();
  SolveResult r;
  r.stop = stop;
  if (with_optional_effects && settings_.energy_ledger) {
    const Stopwatch watch(r.evaluated_ledgers.seconds);
    r.energy = ledger(motion);
    r.evaluated_ledgers.count = 1;
  }
  const double moment = body_.particle_mass() * spline_moment(settings_.spline) * scales_.cell_size * scales_.cell_size;
  for (int id = 0; id < body_.size(); ++id) {
    const Motion& m = motion[static_cast<std::size_t>(id)];
    const PointState p = body_.point(id);
    const Mat3& c = m.affine_velocity;
    const Vec3 spin(c(2, 1) - c(1, 2), c(0, 2) - c(2, 0), c(1, 0) - c(0, 1));
    r.particles.push_back({p.displacement, m.velocity, moment * spin, p.damage, p.damage_time});
    r.damaged_share += p.damage >= cracked;
  }
  r.damaged_share /= static_cast<double>(body_.size());
  for (const ContactLoad& load : loads_) r.loads.push_back(load.result());
  r.cell_size = scales_.cell_size;
  r.time_step = scales_.time_step;
  r.duration = time_;
  r.steps = steps_;
  r.particle_mass = body_.particle_mass();
  r.work = work_;
  r.impact_energy = impact_energy_;
  r.failures = body_.failures();
  r.cracks = cracks_.damage(body_);
  r.nuclei = cracks_.nuclei();
  r.two_field_steps = two_field_steps_;
  r.scattered_points = cracks_.scatter();
  r.crushed_resets = body_.resets();
  r.memory = body_.memory();
  r.band_width = settings_.band_width * scales_.cell_size;
  const Material& m = input_.material;
  r.admissible_length = admissible_length(m.youngs_modulus, m.tensile_strength, m.fracture_energy);
  r.propagation_strength = cracks_.law().strength;
  return r;
}

}  // namespace

const char* name_of(StopReason reason) {
  switch (reason) {
    case StopReason::quiet:
      return "quiet";
    case StopReason::time_limit:
      return "time limit";
    case StopReason::damage:
      return "damaged share";
    case StopReason::steps:
      return "step limit";
  }
  return "";
}

Forecast forecast(const SolveInput& input, const Box& box, long count, const SolveSettings& settings) {
  const Scales scales(input, box, count, settings);
  const double contact = contact_duration(input, input.material.density * input.volume);
  const auto steps = [&](double time) {
    return std::min(settings.most_steps, static_cast<long>(std::ceil(time / scales.time_step)));
  };
  return {scales.cell_size, scales.time_step, steps(std::max(contact, settings.quiet_transits * scales.transit)),
          steps(contact + settings.most_transits * scales.transit)};
}

SolveResult solve(const SolveInput& input, const SolveSettings& settings, Progress& progress) {
  check(input, settings);
  Solver solver(input, settings);
  std::optional<StopReason> stop;
  for (long n = 0; !(stop = solver.finished()); ++n) {
    if (n % 16 == 0) progress.checkpoint("solve", solver.fraction());
    solver.advance();
  }
  return solver.result(*stop);
}

}  // namespace sunder::mpm
