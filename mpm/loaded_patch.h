#pragma once
/// The particles that carry a load, and the force of a load on the grid.
#include <vector>

#include "mpm/continuum.h"

namespace sunder::mpm {

/// Particles below a circular contact patch with Hertzian weights sqrt(1 - r^2/a^2) that sum to 1.
class LoadedPatch {
 public:
  /// Particles within `radius` of the axis through `point` along `outward` and not deeper than 0.6 max(radius, h) + 0.5
  /// h, in material coordinates; the nearest particle when there is none.
  LoadedPatch(const Continuum& body, const Vec3& point, const Vec3& outward, double radius);

  double radius() const { return radius_; }
  /// Weighted displacement along -outward: how far the surface has given way [m].
  double indentation(const Continuum& body) const;
  /// Lets go of particles that escaped; false when none is left.
  bool drop_escaped(const Continuum& body);
  /// Adds an impulse [N s] along -outward to the grid's momentum.
  void push(double impulse, Continuum& body) const;

 private:
  Vec3 outward_;
  double radius_;
  std::vector<int> particles_;
  std::vector<double> weights_;
};

}  // namespace sunder::mpm
