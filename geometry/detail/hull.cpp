#include "geometry/detail/hull.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include <CGAL/enum.h>
#include <Eigen/Eigenvalues>

#include "geometry/detail/cgal_mesh.h"
#include "geometry/detail/shells.h"

namespace sunder::geometry::detail {
namespace {

// Points within this share of the size above the hull are rounding.
constexpr double kRounding = 1e-13;

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

CGAL::Orientation side(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& x) {
  return CGAL::orientation(to_point(a), to_point(b), to_point(c), to_point(x));
}

// Four points that span space, the first three turning left seen from the fourth, as far apart as rounding tells.
std::optional<std::array<int, 4>> spanning_points(const std::vector<Vec3>& points) {
  if (points.size() < 4) return std::nullopt;
  const int a = farthest(points, [](const Vec3& x) { return -x.x(); });
  const int b = farthest(points, [&](const Vec3& x) { return (x - points[a]).squaredNorm(); });
  const Vec3 ab = points[b] - points[a];
  const int c = farthest(points, [&](const Vec3& x) { return ab.cross(x - points[a]).squaredNorm(); });
  const auto exact = [&](const Vec3& x) { return side(points[a], points[b], points[c], x); };
  const Vec3 normal = ab.cross(points[c] - points[a]).normalized();
  int d = farthest(points, [&](const Vec3& x) { return std::abs(normal.dot(x - points[a])); });
  if (exact(points[d]) == CGAL::COPLANAR) d = farthest(points, [&](const Vec3& x) { return std::abs(exact(x)); });
  if (exact(points[d]) == CGAL::COPLANAR) return std::nullopt;
  return exact(points[d]) == CGAL::POSITIVE ? std::array{a, b, c, d} : std::array{a, c, b, d};
}

// Quickhull (Barber, Dobkin and Huhdanpaa 1996) that always adds the point farthest from the hull so far, so that it
// can stop at a distance. Distances are rounded; what a point sees is decided exactly.
class GreedyHull {
 public:
  GreedyHull(const std::vector<Vec3>& points, const std::array<int, 4>& first, double tolerance)
      : points_(points), tolerance_(tolerance), next_(points.size(), kNone), face_from_(points.size(), kNone) {
    const auto [a, b, c, d] = first;
    for (const Triangle& corners : {Triangle{a, c, b}, {a, b, d}, {b, c, d}, {c, a, d}}) add_face(corners);
    faces_[0].across = {3, 2, 1};
    faces_[1].across = {0, 2, 3};
    faces_[2].across = {0, 3, 1};
    faces_[3].across = {0, 1, 2};
    for (int i = 0; i < static_cast<int>(points.size()); ++i) {
      if (i != a && i != b && i != c && i != d) assign(i, 0);
    }
  }

  void grow(int max_vertices) {
    for (int count = 4; count < max_vertices;) {
      const int face = farthest_face();
      if (face == kNone) return;
      const int point = take_farthest(face);
      const int seen = is_seen(face, point) ? face : any_seen(point);
      if (seen == kNone) continue;
      add(point, seen);
      ++count;
    }
    if (const int face = farthest_face(); face != kNone) left_out_ = std::max(left_out_, reach_[face]);
  }

  SmallHull result() const {
    std::vector<Triangle> faces;
    for (const Face& face : faces_) {
      if (face.alive) faces.push_back(face.corners);
    }
    return {compact(points_, faces), left_out_};
  }

 private:
  static constexpr int kNone = -1;

  struct Face {
    Vec3 normal, corner;  // the normal is of length 1, or zero
    Triangle corners{};
    std::array<int, 3> across{};  // the faces beyond the edges from corner k to the next
    int points = kNone;           // the first of those above it
    int farthest = kNone;
    bool alive = true, has_outward = false;
    std::array<Vec3, 3> outward;  // in the plane, square to the edges; made when first needed
  };

  void add_face(const Triangle& corners) {
    Face& face = faces_.emplace_back();
    const Vec3 &a = points_[corners[0]], &b = points_[corners[1]], &c = points_[corners[2]];
    face.normal = (b - a).cross(c - a).normalized();
    face.corner = a;
    face.corners = corners;
    reach_.push_back(0);
  }

  void find_outward(Face& face) const {
    for (int k = 0; k < 3; ++k) {
      const Vec3 edge = points_[face.corners[(k + 1) % 3]] - points_[face.corners[k]];
      face.outward[k] = edge.cross(face.normal);
    }
    face.has_outward = true;
  }

  // Beyond a sharp edge a point is far away although it is hardly above any face.
  double distance(Face& face, const Vec3& x) const {
    if (!face.has_outward) find_outward(face);
    bool over_face = true;
    double nearest = std::numeric_limits<double>::infinity();
    for (int k = 0; k < 3; ++k) {
      const Vec3& a = points_[face.corners[k]];
      if (face.outward[k].dot(x - a) <= 0) continue;
      over_face = false;
      const Vec3 edge = points_[face.corners[(k + 1) % 3]] - a;
      const double along = std::clamp(edge.dot(x - a) / edge.squaredNorm(), 0.0, 1.0);
      nearest = std::min(nearest, (x - a - along * edge).squaredNorm());
    }
    return over_face ? face.normal.dot(x - face.corner) : std::sqrt(nearest);
  }

  // To the face that the point is highest above, of those from `first` on.
  void assign(int point, int first) {
    const Vec3& x = points_[point];
    int best = kNone;
    double highest = 0;
    for (int i = first; i < static_cast<int>(faces_.size()); ++i) {
      const double height = faces_[i].normal.dot(x - faces_[i].corner);
      if (height > highest) highest = height, best = i;
    }
    if (best == kNone) return;
    Face& face = faces_[best];
    const double far = distance(face, x);
    if (far <= tolerance_) {
      left_out_ = std::max(left_out_, far);
      return;
    }
    next_[point] = face.points;
    face.points = point;
    if (far > reach_[best]) reach_[best] = far, face.farthest = point;
  }

  int farthest_face() const {
    const auto most = std::max_element(reach_.begin(), reach_.end());
    return *most > 0 ? static_cast<int>(most - reach_.begin()) : kNone;
  }

  int take_farthest(int from) {
    Face& face = faces_[from];
    const int taken = face.farthest;
    reach_[from] = 0;
    for (int* link = &face.points; *link != kNone;) {
      if (*link == taken) {
        *link = next_[taken];
        continue;
      }
      const double far = distance(face, points_[*link]);
      if (far > reach_[from]) reach_[from] = far, face.farthest = *link;
      link = &next_[*link];
    }
    return taken;
  }

  bool is_seen(int face, int point) const {
    const auto [a, b, c] = faces_[face].corners;
    return side(points_[a], points_[b], points_[c], points_[point]) == CGAL::POSITIVE;
  }

  int any_seen(int point) const {
    for (int i = 0; i < static_cast<int>(faces_.size()); ++i) {
      if (faces_[i].alive && is_seen(i, point)) return i;
    }
    return kNone;
  }

  void add(int point, int seen) {
    const int first_new = static_cast<int>(faces_.size());
    take_away_seen(point, seen);
    for (const int face : gone_) {
      for (int k = 0; k < 3; ++k) {
        if (faces_[faces_[face].across[k]].alive) add_over_edge(face, k, point);
      }
    }
    for (int face = first_new; face < static_cast<int>(faces_.size()); ++face) {
      const int following = face_from_[faces_[face].corners[1]];
      faces_[face].across[1] = following;
      faces_[following].across[2] = face;
    }
    for (const int face : gone_) {
      for (int x = faces_[face].points; x != kNone;) {
        const int following = next_[x];
        assign(x, first_new);
        x = following;
      }
    }
  }

  void take_away_seen(int point, int seen) {
    gone_ = {seen};
    faces_[seen].alive = false;
    for (std::size_t i = 0; i < gone_.size(); ++i) {
      for (const int beyond : faces_[gone_[i]].across) {
        if (!faces_[beyond].alive || !is_seen(beyond, point)) continue;
        faces_[beyond].alive = false;
        gone_.push_back(beyond);
      }
    }
    for (const int face : gone_) reach_[face] = 0;
  }

  void add_over_edge(int face, int k, int point) {
    const int beyond = faces_[face].across[k], from = faces_[face].corners[k], to = faces_[face].corners[(k + 1) % 3];
    const int made = static_cast<int>(faces_.size());
    add_face({from, to, point});
    faces_[made].across[0] = beyond;
    face_from_[from] = made;
    for (int j = 0; j < 3; ++j) {
      if (faces_[beyond].corners[j] == to) faces_[beyond].across[j] = made;
    }
  }

  const std::vector<Vec3>& points_;
  double tolerance_;
  std::vector<Face> faces_;
  std::vector<double> reach_;   // per face: distance of the farthest point above it
  std::vector<int> gone_;       // the faces that the last point took away
  std::vector<int> next_;       // per point: the next above the same face
  std::vector<int> face_from_;  // per point: the face that was made last over an edge from it
  double left_out_ = 0;
};

}  // namespace

SmallHull small_convex_hull(const std::vector<Vec3>& points, double tolerance, int max_vertices) {
  const auto first = spanning_points(points);
  if (!first) return {};
  const double size = (points[(*first)[1]] - points[(*first)[0]]).norm();
  GreedyHull hull(points, *first, std::max(tolerance, kRounding * size));
  hull.grow(max_vertices);
  return hull.result();
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
