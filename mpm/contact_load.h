#pragma once
/// A load while it acts: the gap between the body's surface and its partner, and the force that closes it.
#include <optional>
#include <vector>

#include "mpm/hertz_contact.h"
#include "mpm/loaded_patch.h"
#include "mpm/solve.h"

namespace sunder::mpm {

/// Duration of the impact of reduced mass m at speed v with crushing, from the one-degree-of-freedom contact [s].
/// Equals hertz_duration when the contact stays elastic.
double impact_duration(double reduced_mass, double speed, const ContactPair& pair);

/// Reduced mass of a body and its partner [kg].
double reduced_mass(double body_mass, double partner_mass);

class ContactLoad {
 public:
  ContactLoad(const Load& load, double body_mass, const Partner& partner, const Material& material,
              const SolveSettings& settings, const Continuum& body);

  /// Force of this step [N], from the indentation at `time` given how far the partner has been slowed (displacement of
  /// the partner by its change of velocity, a vector); books the work of the step before.
  double evaluate(const Continuum& body, const Vec3& partner_displacement, double time, double time_step);
  /// Applies the force to the grid and returns the impulse on the partner [N s].
  Vec3 apply(double time_step, Continuum& body);
  /// After particles escaped: forget them.
  void drop_escaped(const Continuum& body);

  double work() const { return work_; }
  const LoadResult& result() const { return result_; }
  const Load& load() const { return load_; }

 private:
  void widen_patch(const Continuum& body);

  Load load_;
  HertzContact contact_;
  LoadModel model_;
  double patch_compliance_;  ///< times the radius of the patch [m^2/N]
  double widest_contact_;    ///< in radii of the patch, before it is widened
  double prescribed_peak_ = 0, prescribed_duration_ = 0;
  LoadedPatch patch_;
  bool attached_ = true;
  double gap_ = 0, indentation_ = 0, force_ = 0, work_ = 0;
  LoadResult result_;
};

}  // namespace sunder::mpm
