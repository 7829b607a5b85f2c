#include "geometry/mass_properties.h"

#include <cmath>

namespace sunder::geometry {
namespace {

// A volume below this share of the cubed box diagonal is rounding: the mesh is flat or not closed around anything.
constexpr double kFlat = 1e-14;

struct Moments {
  double volume = 0, area = 0;
  Vec3 first = Vec3::Zero();   // integral of x
  Mat3 second = Mat3::Zero();  // integral of x x^T
};

// Adds the signed tetrahedron (origin, a, b, c): integrals of 1, x and x x^T over a simplex with one vertex at the
// origin, det/6, det/24 s and det/120 (s s^T + a a^T + b b^T + c c^T) with s = a + b + c.
void add_tetrahedron(Moments& moments, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 normal = (b - a).cross(c - a);
  const double det = a.dot(normal);
  const Vec3 s = a + b + c;
  moments.volume += det / 6;
  moments.area += normal.norm() / 2;
  moments.first += det / 24 * s;
  moments.second += det / 120 * (s * s.transpose() + a * a.transpose() + b * b.transpose() + c * c.transpose());
}

}  // namespace

MassProperties mass_properties(const TriangleMesh& mesh) {
  MassProperties result;
  const Box box = bounds(mesh);
  if (box.isEmpty()) return result;
  const Vec3 origin = box.center();
  Moments moments;
  for (const auto& [i, j, k] : mesh.faces) {
    add_tetrahedron(moments, mesh.vertices[i] - origin, mesh.vertices[j] - origin, mesh.vertices[k] - origin);
  }
  const bool flat = std::abs(moments.volume) <= kFlat * std::pow(box.diagonal().norm(), 3);
  const Vec3 arm = flat ? Vec3(Vec3::Zero()) : Vec3(moments.first / moments.volume);
  const Mat3 second = moments.second - moments.volume * arm * arm.transpose();
  result.volume = moments.volume;
  result.area = moments.area;
  result.centroid = origin + arm;
  result.inertia = second.trace() * Mat3::Identity() - second;
  return result;
}

}  // namespace sunder::geometry
