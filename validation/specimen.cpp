#include "validation/specimen.h"

#include <cmath>

#include "core/random.h"

namespace sunder::validation {
namespace {

Lattice fill(const Box& box, const Vec3& spacing, const std::function<bool(const Vec3&)>& inside, double jitter) {
  Lattice lattice;
  const Vec3 counts = (box.sizes().array() / spacing.array()).round().max(1);
  std::uint64_t n = 0;
  for (double i = 0.5; i < counts[0]; ++i)
    for (double j = 0.5; j < counts[1]; ++j)
      for (double k = 0.5; k < counts[2]; ++k, ++n) {
        const Vec3 x = box.min() + Vec3(i, j, k).cwiseProduct(spacing);
        if (inside && !inside(x)) continue;
        const Vec3 shift(random_unit(1, 0, n) - 0.5, random_unit(1, 1, n) - 0.5, random_unit(1, 2, n) - 0.5);
        lattice.points.push_back(x + 2 * jitter * shift.cwiseProduct(spacing));
      }
  return lattice;
}

mpm::ContinuumSettings continuum(const Lattice& lattice, const mpm::Material& m, const SpecimenSettings& settings) {
  mpm::ContinuumSettings result;
  result.cell_size = lattice.cell_size;
  result.time_step = settings.solve.cfl * lattice.cell_size / m.p_wave_speed();
  result.viscosity = settings.viscosity * m.density * m.p_wave_speed() * lattice.cell_size;
  result.spline = settings.solve.spline;
  result.anchor = settings.anchor.value_or(mpm::box_of(lattice.points).min());
  return result;
}

std::vector<mpm::Motion> first_motion(const Lattice& lattice, const SpecimenSettings& settings) {
  const Mat3& g = settings.velocity_gradient;
  std::vector<mpm::Motion> motion;
  for (const Vec3& x : lattice.points) motion.push_back(settings.motion ? settings.motion(x) : mpm::Motion{g * x, g});
  return motion;
}

mpm::SolveSettings with_model(mpm::SolveSettings settings, Damage damage) {
  settings.damage = damage == Damage::local ? mpm::DamageModel::local : mpm::DamageModel::front;
  return settings;
}

}  // namespace

Lattice solid(const Box& box, double cell_size, const std::function<bool(const Vec3&)>& inside, double jitter) {
  Lattice lattice = fill(box, Vec3::Constant(0.5 * cell_size), inside, jitter);
  lattice.cell_size = cell_size;
  lattice.particle_volume = cell_size * cell_size * cell_size / 8;
  return lattice;
}

Lattice plane(const Box& box, double cell_size, const std::function<bool(const Vec3&)>& inside, double jitter) {
  Box layer = box;
  layer.min()[2] = -0.5 * cell_size;
  layer.max()[2] = 0.5 * cell_size;
  Lattice lattice = fill(layer, Vec3(0.5, 0.5, 1) * cell_size, inside, jitter);
  for (Vec3& x : lattice.points) x[2] = 0;
  lattice.cell_size = cell_size;
  lattice.particle_volume = cell_size * cell_size * cell_size / 4;
  return lattice;
}

Specimen::Specimen(const Lattice& lattice, const mpm::Material& material, const SpecimenSettings& settings)
    : body(lattice.points, lattice.particle_volume, material, continuum(lattice, material, settings)),
      motion_(first_motion(lattice, settings)),
      particle_volume_(lattice.particle_volume),
      time_step_(settings.solve.cfl * lattice.cell_size / material.p_wave_speed()),
      plane_strain_(settings.plane_strain) {
  if (settings.damage != Damage::none)
    cracks_.emplace(material, with_model(settings.solve, settings.damage), lattice.points, body);
  hold(settings.held);
}

void Specimen::hold(std::vector<mpm::HeldRegion> regions) {
  asked_.assign(regions.size(), {Vec3::Zero(), time_});
  if (plane_strain_)
    regions.push_back({Box(Vec3::Constant(-1e9), Vec3::Constant(1e9)), Vec3::Zero(), {false, false, true}});
  body.hold(std::move(regions));
}

void Specimen::crack(const std::function<bool(const Vec3&)>& in_crack, const Vec3& normal) {
  for (int id = 0; id < body.size(); ++id)
    if (in_crack(body.material_position(id))) cracks_->seed(id, normal, body);
}

void Specimen::step(const std::function<void(Specimen&)>& load) {
  if (steps_ == 0) {
    body.start(motion_);
    body.update_grid();
  }
  time_ += time_step_;
  body.advance(time_);
  if (cracks_) cracks_->grow(time_, body);
  if (load) load(*this);
  body.update_grid();
  ++steps_;
}

Vec3 Specimen::force(std::size_t region) {
  Asked& last = asked_[region];
  const Vec3 impulse = body.held_impulses()[region];
  const Vec3 mean = time_ > last.time ? Vec3((impulse - last.impulse) / (time_ - last.time)) : Vec3(Vec3::Zero());
  last = {impulse, time_};
  return mean;
}

long Specimen::failed() const {
  long count = 0;
  for (int id = 0; id < body.size(); ++id) count += body.point(id).damage >= mpm::failed_damage;
  return count;
}

double Specimen::dissipated() const {
  double sum = 0;
  for (int id = 0; id < body.size(); ++id) sum += body.point(id).dissipated;
  return sum * particle_volume_;
}

}  // namespace sunder::validation
