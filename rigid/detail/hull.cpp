#include "rigid/detail/hull.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <LinearMath/btConvexHullComputer.h>

namespace sunder::rigid::detail {
namespace {

// btConvexHullComputer works on a grid of about 1e-4 of the hull's size: finer differences of planes are not real.
constexpr double coplanar_offset = 2e-4;  // of the radius
constexpr double coplanar_angle = 1e-4;   // [rad]
constexpr double flat_thickness = 1e-6;   // of the radius

std::vector<int> loop_of(const btConvexHullComputer& computer, int first_edge) {
  std::vector<int> loop;
  const auto* first = &computer.edges[first_edge];
  const auto* edge = first;
  do {
    loop.push_back(edge->getSourceVertex());
    edge = edge->getNextEdgeOfFace();
  } while (edge != first);
  return loop;
}

// Newell's method: the area vector of a closed loop.
Vec3 area_vector(const std::vector<Vec3>& points, const std::vector<int>& loop) {
  Vec3 area = Vec3::Zero();
  const Vec3& origin = points[loop[0]];
  for (std::size_t k = 1; k + 1 < loop.size(); ++k)
    area += (points[loop[k]] - origin).cross(points[loop[k + 1]] - origin) / 2;
  return area;
}

double support(const std::vector<Vec3>& points, const Vec3& direction) {
  double best = -std::numeric_limits<double>::infinity();
  for (const Vec3& p : points) best = std::max(best, direction.dot(p));
  return best;
}

// All points on the supporting plane, turned counter-clockwise about its normal.
std::vector<int> points_on_plane(const std::vector<Vec3>& points, const Vec3& normal, double offset, double tolerance) {
  std::vector<int> on;
  Vec3 centre = Vec3::Zero();
  for (int i = 0; i < static_cast<int>(points.size()); ++i) {
    if (normal.dot(points[i]) < offset - tolerance) continue;
    on.push_back(i);
    centre += points[i];
  }
  centre /= static_cast<double>(on.size());
  const Vec3 u = normal.unitOrthogonal(), v = normal.cross(u);
  std::vector<std::pair<double, int>> by_angle;
  for (int i : on) by_angle.emplace_back(std::atan2(v.dot(points[i] - centre), u.dot(points[i] - centre)), i);
  std::sort(by_angle.begin(), by_angle.end());
  for (std::size_t k = 0; k < on.size(); ++k) on[k] = by_angle[k].second;
  return on;
}

bool is_known(const std::vector<HullFace>& faces, const Vec3& normal) {
  return std::any_of(faces.begin(), faces.end(),
                     [&](const HullFace& f) { return (f.normal - normal).norm() < coplanar_angle; });
}

}  // namespace

std::optional<Hull> make_hull(const geometry::TriangleMesh& mesh, const Mat3& linear) {
  if (mesh.vertices.size() < 4) return std::nullopt;
  std::vector<Vec3> input;
  for (const Vec3& x : mesh.vertices) input.push_back(linear * x);
  btConvexHullComputer computer;
  computer.compute(input[0].data(), sizeof(Vec3), static_cast<int>(input.size()), 0, 0);

  Hull hull;
  Box box;
  for (int i = 0; i < computer.vertices.size(); ++i) {
    hull.points.push_back(input[computer.original_vertex_index[i]]);
    box.extend(hull.points.back());
  }
  if (hull.points.size() < 4) return std::nullopt;
  hull.middle = box.center();
  hull.radius = box.diagonal().norm() / 2;
  hull.thickness = 2 * hull.radius;
  for (int i = 0; i < computer.faces.size(); ++i) {
    const Vec3 area = area_vector(hull.points, loop_of(computer, computer.faces[i]));
    if (area.norm() < 1e-9 * hull.radius * hull.radius) continue;
    HullFace face;
    face.normal = area.normalized();
    if (is_known(hull.faces, face.normal)) continue;
    face.offset = support(hull.points, face.normal);
    face.loop = points_on_plane(hull.points, face.normal, face.offset, coplanar_offset * hull.radius);
    if (face.loop.size() < 3) continue;
    hull.thickness = std::min(hull.thickness, face.offset + support(hull.points, -face.normal));
    hull.faces.push_back(std::move(face));
  }
  if (hull.faces.size() < 4 || hull.thickness < flat_thickness * hull.radius) return std::nullopt;

  hull.shape = std::make_unique<btConvexHullShape>();
  hull.shape->setMargin(0);
  for (const Vec3& p : hull.points) hull.shape->addPoint(btVector3(p.x(), p.y(), p.z()), false);
  hull.shape->recalcLocalAabb();
  return hull;
}

}  // namespace sunder::rigid::detail
