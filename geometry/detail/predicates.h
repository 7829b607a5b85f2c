#pragma once
/// Exact signs of determinants of input coordinates: a bound on the rounding error decides almost always, CGAL the
/// rest.
#include <cmath>

#include "core/types.h"

namespace sunder::geometry::detail {

inline int sign_of(double x) { return (x > 0) - (x < 0); }

int exact_orientation(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);

/// +1 when d lies on the side of the plane (a, b, c) that the normal of the counter-clockwise triangle points to, -1 on
/// the other side, 0 on the plane.
inline int orientation(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  // Shewchuk, "Adaptive precision floating-point arithmetic" (1997), bound A of orient3d.
  constexpr double kBound = (7 + 56 * 0x1p-53) * 0x1p-53;
  const double ux = b.x() - a.x(), uy = b.y() - a.y(), uz = b.z() - a.z();
  const double vx = c.x() - a.x(), vy = c.y() - a.y(), vz = c.z() - a.z();
  const double wx = d.x() - a.x(), wy = d.y() - a.y(), wz = d.z() - a.z();
  const double p = vy * wz, q = vz * wy, r = vz * wx, s = vx * wz, t = vx * wy, u = vy * wx;
  const double det = ux * (p - q) + uy * (r - s) + uz * (t - u);
  const double permanent = std::abs(ux) * (std::abs(p) + std::abs(q)) + std::abs(uy) * (std::abs(r) + std::abs(s)) +
                           std::abs(uz) * (std::abs(t) + std::abs(u));
  // Below the second bound products may have lost digits to underflow.
  if (std::abs(det) > kBound * permanent && permanent > 1e-280) return sign_of(det);
  return exact_orientation(a, b, c, d);
}

/// The same in the plane, of points given by two coordinates each: +1 for a left turn.
int planar_orientation(double ax, double ay, double bx, double by, double cx, double cy);

bool collinear(const Vec3& a, const Vec3& b, const Vec3& c);

/// Of four coplanar points: whether c and d lie strictly on the same side of the line (a, b).
bool on_same_side(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);

/// Whether the closed segment (p, q) and the closed triangle (a, b, c) have a point in common.
bool meet(const Vec3& p, const Vec3& q, const Vec3& a, const Vec3& b, const Vec3& c);

}  // namespace sunder::geometry::detail
