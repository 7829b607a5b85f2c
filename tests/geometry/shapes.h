#pragma once
/// Families of shapes for the tests of this folder.
#include <cstdlib>
#include <filesystem>
#include <utility>

#include <rapidcheck.h>

#include "geometry/mesh.h"
#include "geometry/primitives.h"

namespace sunder::geometry {

/// Uniform in [low, high], to 1e-6 of the range, so that failures shrink.
inline double arbitrary_real(double low, double high) {
  return low + (high - low) * *rc::gen::inRange(0, 1000001) * 1e-6;
}

inline Vec3 arbitrary_vector(double size) {
  const double x = arbitrary_real(-size, size), y = arbitrary_real(-size, size), z = arbitrary_real(-size, size);
  return {x, y, z};
}

inline Mat3 arbitrary_rotation() {
  const Vec3 v = arbitrary_vector(3);
  return v.norm() > 0 ? Mat3(Eigen::AngleAxisd(v.norm(), v.normalized()).toRotationMatrix()) : Mat3(Mat3::Identity());
}

/// A closed solid of about 1 m.
inline TriangleMesh arbitrary_shape() {
  const double a = arbitrary_real(0.2, 1), b = arbitrary_real(0.2, 1);
  switch (*rc::gen::inRange(0, 7)) {
    case 0:
      return box({a, b, arbitrary_real(0.2, 1)});
    case 1:
      return sphere(a, 2);
    case 2:
      return cylinder(a, b, *rc::gen::inRange(3, 40));
    case 3:
      return torus(1, 0.9 * a, *rc::gen::inRange(3, 40), *rc::gen::inRange(3, 40));
    case 4:
      return hollow_sphere(a, b * 0.9 * a, 2);
    case 5:
      return cylinder(a, 3 * b, 5);
    default:
      // A thick cup.
      return revolve({{0, 0}, {a, 0}, {a, b}, {0.5 * a, b}, {0.5 * a, 0.3 * b}, {0, 0.3 * b}},
                     *rc::gen::inRange(3, 40));
  }
}

inline TriangleMesh inside_out(TriangleMesh mesh) {
  for (Triangle& face : mesh.faces) std::swap(face[1], face[2]);
  return mesh;
}

inline TriangleMesh moved(const TriangleMesh& mesh, const Vec3& offset) {
  return transformed(mesh, Mat3::Identity(), offset);
}

inline TriangleMesh together(TriangleMesh a, const TriangleMesh& b) {
  const int first = static_cast<int>(a.vertices.size());
  a.vertices.insert(a.vertices.end(), b.vertices.begin(), b.vertices.end());
  for (const auto& [i, j, k] : b.faces) a.faces.push_back({first + i, first + j, first + k});
  return a;
}

/// Scanned meshes that the bootstrap unpacks from CGAL's demo data; tests that need one skip themselves where it is
/// missing.
inline std::filesystem::path sample_mesh(const std::string& name) {
  const char* folder = std::getenv("SUNDER_MESHES");
  return std::filesystem::path(folder != nullptr ? folder : SUNDER_SOURCE_DIR "/build/meshes") / name;
}

}  // namespace sunder::geometry
