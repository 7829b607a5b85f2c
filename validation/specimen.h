#pragma once
/// Bodies in testing machines: lattices of particles, held and pulled, with or without damage.
#include <functional>
#include <optional>
#include <vector>

#include "mpm/crack_growth.h"

namespace sunder::validation {

/// Points on a lattice of half the cell size.
struct Lattice {
  std::vector<Vec3> points;
  double cell_size = 0;        ///< [m]
  double particle_volume = 0;  ///< [m^3]
};

/// Fills `box`; `inside` tells what of it is solid (everything, if empty). `jitter` in lattice spacings.
Lattice solid(const Box& box, double cell_size, const std::function<bool(const Vec3&)>& inside = {}, double jitter = 0);
/// One layer of particles in the plane z = 0 of the same box, of thickness one cell: for plane strain. All columns of
/// nodes along z move alike.
Lattice plane(const Box& box, double cell_size, const std::function<bool(const Vec3&)>& inside = {}, double jitter = 0);

enum class Damage { none, local, front };

struct SpecimenSettings {
  mpm::SolveSettings solve;  ///< cfl, band, fronts, spline; its damage model is set by `damage`
  Damage damage = Damage::none;
  bool plane_strain = false;                       ///< no motion along z
  std::vector<mpm::HeldRegion> held;               ///< the grips
  Mat3 velocity_gradient = Mat3::Zero();           ///< the body starts at velocity G x [1/s]
  std::function<mpm::Motion(const Vec3&)> motion;  ///< at which it starts instead, by material position
  double viscosity = 0;                            ///< in rho c_p h
  std::optional<Vec3> anchor;                      ///< of the grid; default: the lowest corner of the points
};

class Specimen {
 public:
  Specimen(const Lattice& lattice, const mpm::Material& material, const SpecimenSettings& settings);

  /// `load` may push the body; it is called when the points are where they are at time().
  void step(const std::function<void(Specimen&)>& load = {});
  /// Other grips from now on; forces count from here.
  void hold(std::vector<mpm::HeldRegion> regions);
  double time() const { return time_; }
  double time_step() const { return time_step_; }
  long steps() const { return steps_; }
  double particle_steps() const { return static_cast<double>(steps_) * body.size(); }
  /// A sharp crack: the points that `in_crack` names have failed, across `normal`. For Damage::front, before the first
  /// step.
  void crack(const std::function<bool(const Vec3&)>& in_crack, const Vec3& normal);
  /// Force of a held region on the body, averaged since this was last asked for it [N].
  Vec3 force(std::size_t region);
  /// Failed particles, and the energy that damage dissipated [J].
  long failed() const;
  double dissipated() const;

  mpm::Continuum body;

 private:
  const std::vector<mpm::Motion> motion_;
  const double particle_volume_, time_step_;
  const bool plane_strain_;
  double time_ = 0;
  long steps_ = 0;
  std::optional<mpm::CrackGrowth> cracks_;
  struct Asked {
    Vec3 impulse = Vec3::Zero();
    double time = 0;
  };
  std::vector<Asked> asked_;
};

}  // namespace sunder::validation
