#include "geometry/detail/hull.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include <CGAL/convex_hull_3.h>
#include <Eigen/Eigenvalues>

#include "geometry/detail/cgal_mesh.h"
#include "geometry/detail/shells.h"

namespace sunder::geometry::detail {
namespace {

// Maps the points into a cube of about unit size; hull vertices stay hull vertices under an affine map.
Mat3 to_even_extents(const std::vector<Vec3>& points) {
  const Mat3 axes = principal_axes(points);
  Box box;
  for (const Vec3& x : points) box.extend(axes.transpose() * x);
  Vec3 scale = box.diagonal();
  for (double& length : scale) length = length > 0 ? 1 / length : 1;
  return scale.asDiagonal() * axes.transpose();
}

// A hull that grows point by point (Clarkson and Shor 1989 without the conflict graph: the points are few). CGAL's own
// orders faces by address, so its triangulation of coplanar points differs from run to run.
class GrowingHull {
 public:
  struct Face {
    Triangle corners;
    Vec3 normal;    // unit
    double height;  // of the plane along it
    double area;    // twice the triangle's
  };

  // The fourth point lies on the side from which the other three turn left.
  GrowingHull(const std::vector<Vec3>& points, const std::array<int, 4>& first)
      : points_(points), edges_(points.size() * points.size(), false) {
    const auto [a, b, c, d] = first;
    for (const Triangle& face : {Triangle{a, c, b}, {a, b, d}, {b, c, d}, {c, a, d}}) add_face(face);
  }

  /// sees(face, point): the point lies above the face.
  template <class Sees>
  void add(int point, const Sees& sees) {
    const auto seen =
        std::stable_partition(faces_.begin(), faces_.end(), [&](const Face& face) { return !sees(face, point); });
    if (seen == faces_.end()) return;
    const std::vector<Face> gone(seen, faces_.end());
    faces_.erase(seen, faces_.end());
    mark_edges(gone, true);
    for (const Face& face : gone) {
      for (int k = 0; k < 3; ++k) {
        const int from = face.corners[k], to = face.corners[(k + 1) % 3];
        if (!edge(to, from)) add_face({from, to, point});
      }
    }
    mark_edges(gone, false);
  }

  const std::vector<Face>& faces() const { return faces_; }

 private:
  void add_face(const Triangle& corners) {
    const Vec3& a = points_[corners[0]];
    const Vec3 cross = (points_[corners[1]] - a).cross(points_[corners[2]] - a);
    const double length = cross.norm();
    const Vec3 normal = length > 0 ? Vec3(cross / length) : Vec3(Vec3::Zero());
    faces_.push_back({corners, normal, normal.dot(a), length});
  }

  void mark_edges(const std::vector<Face>& faces, bool mark) {
    for (const Face& face : faces) {
      for (int k = 0; k < 3; ++k) edge(face.corners[k], face.corners[(k + 1) % 3]) = mark;
    }
  }

  std::vector<bool>::reference edge(int from, int to) { return edges_[from * points_.size() + to]; }

  const std::vector<Vec3>& points_;
  std::vector<Face> faces_;
  std::vector<bool> edges_;
};

template <class Measure>
int farthest(const std::vector<Vec3>& points, const Measure& measure) {
  int best = 0;
  double most = measure(points[0]);
  for (std::size_t i = 1; i < points.size(); ++i) {
    const double value = measure(points[i]);
    if (value > most) most = value, best = static_cast<int>(i);
  }
  return best;
}

// Four points that span space, the first three turning left seen from the fourth, as far apart as rounding tells.
std::optional<std::array<int, 4>> spanning_points(const std::vector<Vec3>& points) {
  if (points.size() < 4) return std::nullopt;
  const int a = farthest(points, [](const Vec3& x) { return -x.x(); });
  const int b = farthest(points, [&](const Vec3& x) { return (x - points[a]).norm(); });
  const Vec3 ab = points[b] - points[a];
  const int c = farthest(points, [&](const Vec3& x) { return ab.cross(x - points[a]).norm(); });
  const auto side = [&](const Vec3& x) {
    return CGAL::orientation(to_point(points[a]), to_point(points[b]), to_point(points[c]), to_point(x));
  };
  const Vec3 normal = ab.cross(points[c] - points[a]).normalized();
  int d = farthest(points, [&](const Vec3& x) { return std::abs(normal.dot(x - points[a])); });
  if (side(points[d]) == CGAL::COPLANAR) d = farthest(points, [&](const Vec3& x) { return std::abs(side(x)); });
  if (side(points[d]) == CGAL::COPLANAR) return std::nullopt;
  return side(points[d]) == CGAL::POSITIVE ? std::array{a, b, c, d} : std::array{a, c, b, d};
}

// The points farthest along each direction, each once, in order of index.
std::vector<Vec3> extreme_points(const std::vector<Vec3>& points, const Eigen::MatrixX3d& directions) {
  constexpr Eigen::Index kBlock = 256;  // keeps the products in the cache
  const auto count = static_cast<Eigen::Index>(points.size());
  const Eigen::Map<const Eigen::Matrix3Xd> all(points[0].data(), 3, count);
  Eigen::VectorXd best = Eigen::VectorXd::Constant(directions.rows(), -std::numeric_limits<double>::infinity());
  std::vector<Eigen::Index> winner(directions.rows(), 0);
  for (Eigen::Index start = 0; start < count; start += kBlock) {
    const Eigen::MatrixXd heights =
        all.middleCols(start, std::min(kBlock, count - start)).transpose() * directions.transpose();
    for (Eigen::Index i = 0; i < directions.rows(); ++i) {
      const double highest = heights.col(i).maxCoeff();
      if (highest <= best[i]) continue;
      Eigen::Index where;
      best[i] = heights.col(i).maxCoeff(&where);
      winner[i] = start + where;
    }
  }
  std::sort(winner.begin(), winner.end());
  winner.erase(std::unique(winner.begin(), winner.end()), winner.end());
  std::vector<Vec3> result;
  for (const Eigen::Index i : winner) result.push_back(points[i]);
  return result;
}

}  // namespace

Eigen::Matrix3Xd even_directions(int count) {
  const double golden_angle = 2 * std::numbers::pi * (2 - std::numbers::phi);
  Eigen::Matrix3Xd result(3, count);
  for (int i = 0; i < count; ++i) {
    const double z = 1 - (2 * i + 1.0) / count, radius = std::sqrt(1 - z * z);
    result.col(i) << radius * std::cos(golden_angle * i), radius * std::sin(golden_angle * i), z;
  }
  return result;
}

TriangleMesh convex_hull(const std::vector<Vec3>& points) {
  const auto first = spanning_points(points);
  if (!first) return {};
  std::vector<Kernel::Point_3> exact;
  exact.reserve(points.size());
  for (const Vec3& x : points) exact.push_back(to_point(x));
  GrowingHull hull(points, *first);
  for (int i = 0; i < static_cast<int>(points.size()); ++i) {
    hull.add(i, [&](const GrowingHull::Face& face, int point) {
      const auto [a, b, c] = face.corners;
      return CGAL::orientation(exact[a], exact[b], exact[c], exact[point]) == CGAL::POSITIVE;
    });
  }
  std::vector<Triangle> faces;
  for (const GrowingHull::Face& face : hull.faces()) faces.push_back(face.corners);
  return compact(points, faces);
}

double rough_hull_volume(const std::vector<Vec3>& points) {
  constexpr double kFlat = 1e-9;  // of the size
  const auto first = spanning_points(points);
  if (!first) return 0;
  const Vec3& origin = points[(*first)[0]];
  const double tolerance = kFlat * (points[(*first)[1]] - origin).norm();
  GrowingHull hull(points, *first);
  for (int i = 0; i < static_cast<int>(points.size()); ++i) {
    hull.add(i, [&](const GrowingHull::Face& face, int point) {
      return face.normal.dot(points[point]) - face.height > tolerance;
    });
  }
  double six_volumes = 0;
  for (const GrowingHull::Face& face : hull.faces()) {
    six_volumes += face.area * (face.height - face.normal.dot(origin));
  }
  return six_volumes / 6;
}

SmallHull small_convex_hull(const std::vector<Vec3>& points, int max_vertices) {
  if (points.empty()) return {};
  const Mat3 map = to_even_extents(points);
  const auto fits = [&](const TriangleMesh& hull) { return static_cast<int>(hull.vertices.size()) <= max_vertices; };
  const int finest = 3 * max_vertices;
  std::vector<Vec3> candidates = points;
  if (static_cast<int>(points.size()) > finest) {
    candidates = extreme_points(points, even_directions(finest).transpose() * map);
  }
  SmallHull hull{convex_hull(candidates), 0};
  hull.full_volume = volume(hull.mesh);
  for (int count = finest; !fits(hull.mesh); count -= std::max(1, max_vertices / 4)) {
    hull.mesh = convex_hull(extreme_points(candidates, even_directions(std::max(4, count)).transpose() * map));
  }
  return hull;
}

Mat3 principal_axes(const std::vector<Vec3>& points) {
  if (points.size() < 2) return Mat3::Identity();
  const Eigen::Map<const Eigen::Matrix3Xd> all(points[0].data(), 3, static_cast<Eigen::Index>(points.size()));
  const Eigen::Matrix3Xd centered = all.colwise() - all.rowwise().mean();
  const Eigen::SelfAdjointEigenSolver<Mat3> solver(centered * centered.transpose());
  Mat3 axes = solver.eigenvectors();
  axes.col(2) = axes.col(0).cross(axes.col(1));
  return axes;
}

double volume(const TriangleMesh& mesh) {
  double six_volumes = 0;
  for (const auto& [a, b, c] : mesh.faces) {
    const Vec3& origin = mesh.vertices[0];
    six_volumes += (mesh.vertices[a] - origin).dot((mesh.vertices[b] - origin).cross(mesh.vertices[c] - origin));
  }
  return six_volumes / 6;
}

}  // namespace sunder::geometry::detail
