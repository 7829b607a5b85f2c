#pragma once
/// Normal contact of two smooth bodies: Hertz until the contact pressure crushes the softer one, then plastic.
#include "core/types.h"

namespace sunder::mpm {

/// Geometry and stiffness of a contact pair.
struct ContactPair {
  double effective_radius = 0;   ///< 1 / (1/R_1 + 1/R_2) [m]
  double effective_modulus = 0;  ///< E* = 1 / ((1 - nu_1^2)/E_1 + (1 - nu_2^2)/E_2) [Pa]
  double contact_pressure =
      std::numeric_limits<double>::infinity();  ///< mean pressure at which the contact crushes [Pa]
};

/// E* of two materials (Johnson 1985, eq. 4.22).
double effective_modulus(double youngs_modulus_1, double poisson_ratio_1, double youngs_modulus_2,
                         double poisson_ratio_2);

/// Elastic impact of reduced mass m [kg] at speed v [m/s] > 0: duration 2.868 (m^2 / (R E*^2 v))^(1/5) [s] (Johnson
/// 1985, 11.24; Fan 3.8-3.11).
double hertz_duration(double reduced_mass, double speed, const ContactPair& pair);

/// Peak force of that impact, 5/4 m v^2 / delta_max with delta_max = (15 m v^2 / (16 sqrt(R) E*))^(2/5) [N]: 1.84 times
/// the mean.
double hertz_peak_force(double reduced_mass, double speed, const ContactPair& pair);

/// Force over indentation with memory of the deepest one. Loading is Hertzian up to the crushing pressure and linear
/// beyond, so that the mean pressure stays there; unloading is Hertzian with the enlarged radius of the flattened
/// contact, after Thornton (1997). Where he caps the peak pressure this caps the mean, and the enlarged radius follows
/// from the patch so that force and patch are continuous.
class HertzContact {
 public:
  explicit HertzContact(const ContactPair& pair);

  /// Force at indentation `d` [m], without remembering it [N]. Never tension.
  double force(double indentation) const;
  /// The same, and the contact remembers that it was there.
  double load(double indentation);
  /// The same for an `approach` of bodies one of which gives way by `patch_compliance` [m/N] in a model of its own: to
  /// be the contact's whole indentation the approach lacks that part of it, of which at most `most_given_back` elastic
  /// indentations are added. With that bound there is one indentation, and the force is a continuous function of the
  /// approach.
  double load_through_patch(double approach, double patch_compliance);
  static constexpr double most_given_back = 0.6;  // below 2/3: Hertz grows with d^1.5

  /// Radius of the contact patch at the deepest indentation so far [m].
  double patch_radius() const { return patch_radius_; }
  /// Elastic part of the indentation that carries `force` [m].
  double elastic_indentation(double force) const;

 private:
  ContactPair pair_;
  double stiffness_;  ///< 4/3 E* sqrt(R)
  double yield_indentation_, yield_force_;
  double deepest_ = 0, residual_ = 0, unloading_radius_ = 0, patch_radius_ = 0;
};

}  // namespace sunder::mpm
