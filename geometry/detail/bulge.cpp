#include "geometry/detail/bulge.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace sunder::geometry::detail {
namespace {

Vec3 area_vector(const std::vector<Vec3>& vertices, const Triangle& face) {
  const Vec3& a = vertices[face[0]];
  return (vertices[face[1]] - a).cross(vertices[face[2]] - a);
}

double fraction(double x) { return x - std::floor(x); }

// Number i of an even sequence in the triangle (additive recurrence: Roberts, "The unreasonable effectiveness of
// quasirandom sequences", 2018).
Vec3 point_in(const std::vector<Vec3>& vertices, const Triangle& face, int i) {
  const double s = std::sqrt(fraction(0.5 + 0.7548776662466927 * i)), t = fraction(0.5 + 0.5698402909980532 * i);
  return (1 - s) * vertices[face[0]] + s * (1 - t) * vertices[face[1]] + s * t * vertices[face[2]];
}

// Along the point's normal to the first face of the hull; 0 when it passes none. A point at a face, or out of the hull
// there, leaves the hull through that face only if it looks that way.
double way_out(const Eigen::MatrixX3d& normals, const Eigen::VectorXd& heights, const SurfacePoint& point,
               double left_out) {
  constexpr double kLooking = 0.5, kNever = std::numeric_limits<double>::infinity();
  const Eigen::ArrayXd depths = (heights - normals * point.position).array();
  const Eigen::ArrayXd ascents = (normals * point.normal).array();
  const auto passed = ascents > kLooking || (ascents > 0 && depths > left_out);
  const double way = passed.select(depths / ascents, kNever).minCoeff();
  return way < kNever ? way : 0;
}

}  // namespace

std::vector<SurfacePoint> even_points(const std::vector<Vec3>& vertices, const std::vector<Triangle>& faces,
                                      int count) {
  double area = 0;
  for (const Triangle& face : faces) area += area_vector(vertices, face).norm();
  std::vector<SurfacePoint> points;
  if (!(area > 0)) return points;
  double passed = 0;
  for (const Triangle& face : faces) {
    const Vec3 normal = area_vector(vertices, face);
    passed += normal.norm();
    while (static_cast<double>(points.size()) + 0.5 <= passed / area * count) {
      points.push_back({point_in(vertices, face, static_cast<int>(points.size())), normal.normalized()});
    }
  }
  return points;
}

std::vector<double> bulges(const TriangleMesh& hull, const std::vector<SurfacePoint>& points, double left_out) {
  const auto count = static_cast<Eigen::Index>(hull.faces.size());
  std::vector<double> result(points.size(), 0);
  if (count == 0) return result;
  Eigen::MatrixX3d normals(count, 3);
  Eigen::VectorXd heights(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const Vec3 normal = area_vector(hull.vertices, hull.faces[i]).normalized();
    normals.row(i) = normal;
    heights[i] = normal.dot(hull.vertices[hull.faces[i][0]]);
  }
  Eigen::Matrix3Xd positions(3, static_cast<Eigen::Index>(points.size()));
  for (std::size_t i = 0; i < points.size(); ++i) positions.col(static_cast<Eigen::Index>(i)) = points[i].position;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double way = way_out(normals, heights, points[i], left_out);
    if (!(way > 0)) continue;
    const Vec3 exit = points[i].position + way * points[i].normal;
    result[i] = std::sqrt((positions.colwise() - exit).colwise().squaredNorm().minCoeff());
  }
  return result;
}

}  // namespace sunder::geometry::detail
