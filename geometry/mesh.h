#pragma once
/// Triangle meshes as plain values.
#include <array>
#include <vector>

#include "core/types.h"

namespace sunder::geometry {

using Triangle = std::array<int, 3>;

/// Indexed triangles; faces turn counter-clockwise seen from outside. Positions in metres.
struct TriangleMesh {
  std::vector<Vec3> vertices;
  std::vector<Triangle> faces;
};

/// Bounding box of all vertices (also of those that no face uses).
Box bounds(const TriangleMesh& mesh);

/// Of one face [m^2].
double face_area(const TriangleMesh& mesh, std::size_t face);

/// Of one face, of unit length; zero for a face without area.
Vec3 face_normal(const TriangleMesh& mesh, std::size_t face);

/// x -> linear * x + offset. A reflection turns the faces so that they keep pointing outward.
TriangleMesh transformed(const TriangleMesh& mesh, const Mat3& linear, const Vec3& offset);

/// True when the faces are a closed, consistently turned two-manifold: every directed edge occurs once and so does its
/// opposite, and the faces around every vertex are one fan. Says nothing of self-intersections (see inspect). False for
/// a mesh without faces.
bool is_closed_two_manifold(const TriangleMesh& mesh);

}  // namespace sunder::geometry
