#include "geometry/detail/predicates.h"

#include "geometry/detail/cgal_mesh.h"

namespace sunder::geometry::detail {

int exact_orientation(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  return static_cast<int>(CGAL::orientation(to_point(a), to_point(b), to_point(c), to_point(d)));
}

int planar_orientation(double ax, double ay, double bx, double by, double cx, double cy) {
  // Shewchuk's bound A of orient2d.
  constexpr double kBound = (3 + 16 * 0x1p-53) * 0x1p-53;
  const double left = (bx - ax) * (cy - ay), right = (by - ay) * (cx - ax);
  const double size = std::abs(left) + std::abs(right);
  if (std::abs(left - right) > kBound * size && size > 1e-280) return sign_of(left - right);
  using Point = Kernel::Point_2;
  return static_cast<int>(CGAL::orientation(Point(ax, ay), Point(bx, by), Point(cx, cy)));
}

bool collinear(const Vec3& a, const Vec3& b, const Vec3& c) {
  return planar_orientation(a.x(), a.y(), b.x(), b.y(), c.x(), c.y()) == 0 &&
         planar_orientation(a.y(), a.z(), b.y(), b.z(), c.y(), c.z()) == 0 &&
         planar_orientation(a.z(), a.x(), b.z(), b.x(), c.z(), c.x()) == 0;
}

bool on_same_side(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  return CGAL::coplanar_orientation(to_point(a), to_point(b), to_point(c), to_point(d)) == CGAL::POSITIVE;
}

bool meet(const Vec3& p, const Vec3& q, const Vec3& a, const Vec3& b, const Vec3& c) {
  const int from = orientation(a, b, c, p), to = orientation(a, b, c, q);
  if (from * to > 0) return false;
  if (from == 0 && to == 0) {
    return CGAL::do_intersect(Kernel::Segment_3(to_point(p), to_point(q)),
                              Kernel::Triangle_3(to_point(a), to_point(b), to_point(c)));
  }
  const int first = orientation(p, q, a, b), second = orientation(p, q, b, c);
  if (first * second < 0) return false;
  const int third = orientation(p, q, c, a);
  return first * third >= 0 && second * third >= 0;
}

}  // namespace sunder::geometry::detail
