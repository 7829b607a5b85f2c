#pragma once
/// What is measured on cracks in plane specimens.
#include <functional>
#include <vector>

#include "mpm/material.h"
#include "validation/specimen.h"

namespace sunder::validation::detail {

/// A point that failed since the specimen was made; seeds of cracks are not among them.
struct Failure {
  Vec3 position;  ///< material [m]
  double time;    ///< [s]
};
std::vector<Failure> failures(const Specimen& specimen);

/// The crack as the mean of its failures in slices of width `slice` along x, which runs from `origin` along `direction`
/// in the plane z = 0; y points to the left of it.
struct CrackSlice {
  double x = 0, y = 0;  ///< [m]
  double first = 0;     ///< earliest failure [s]
  int count = 0;
};
std::vector<CrackSlice> slices(const std::vector<Failure>& failures, const Vec3& origin, const Vec3& direction,
                               double slice);

/// Straight line through the slices: y = offset + slope x.
struct CrackLine {
  double tilt = 0;       ///< [degrees]
  double deviation = 0;  ///< largest |y| of a slice [m]
};
CrackLine line_through(const std::vector<CrackSlice>& slices);

/// 99th percentile of the speed at which slices fail one after the other, over windows of four [m/s].
double crack_speed(const std::vector<CrackSlice>& slices);

/// Sizes of the pieces that sound points form whose neighbours are within `reach` [m], as shares of all points that are
/// `counted`, largest first. Others are left out.
std::vector<double> pieces(const Specimen& specimen, double reach, const std::function<bool(const Vec3&)>& counted);

/// Speed of Rayleigh waves [m/s], from the root of the Rayleigh function.
double rayleigh_speed(const mpm::Material& material);

/// E / (1 - nu^2) [Pa].
double plane_modulus(const mpm::Material& material);

/// Strength at which the softening law on cells of size `h` has a band of `ratio` admissible lengths [Pa].
double strength_of_band(const mpm::Material& material, const mpm::SolveSettings& settings, double h, double ratio);

}  // namespace sunder::validation::detail
