#pragma once
/// Exact point location in a closed mesh, for many points.
#include <array>
#include <vector>

#include "geometry/mesh.h"

namespace sunder::geometry::detail {

/// Counts the faces above a point along +Z (crossing parity). Faces are binned by their shadow on the XY plane.
class InsideTest {
 public:
  /// The mesh must be closed and must outlive the test.
  explicit InsideTest(const TriangleMesh& mesh);

  /// Strictly inside, decided with exact predicates. A point whose vertical line meets an edge or vertex is treated as
  /// if moved by an infinitesimal, the same for all faces, so no crossing is lost or counted twice.
  bool operator()(const Vec3& point) const;

  /// On a face, an edge or a vertex, exactly.
  bool on_surface(const Vec3& point) const;

 private:
  int bin(int axis, double x) const;

  const TriangleMesh& mesh_;
  Box box_;
  std::array<int, 2> bins_{};  // along X and Y
  std::array<double, 2> per_length_{};
  std::vector<int> first_;  // per bin: where its faces start in faces_
  std::vector<int> faces_;
};

}  // namespace sunder::geometry::detail
