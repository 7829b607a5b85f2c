#include "geometry/detail/embedding.h"

#include <atomic>
#include <optional>

#include <tbb/parallel_for.h>

#include "core/error.h"
#include "geometry/detail/predicates.h"

namespace sunder::geometry::detail {
namespace {

using Corners = std::array<const Vec3*, 3>;

Corners corners_of(const std::vector<Vec3>& points, const Triangle& face) {
  return {&points[face[0]], &points[face[1]], &points[face[2]]};
}

// Both triangles turned so that their shared vertices come first, in the same order.
int bring_shared_first(Triangle& a, Triangle& b) {
  int shared = 0;
  for (int i = 0; i < 3; ++i) {
    for (int j = shared; j < 3; ++j) {
      if (a[i] != b[j]) continue;
      std::swap(b[shared], b[j]);
      std::swap(a[shared], a[i]);
      ++shared;
      break;
    }
  }
  return shared;
}

// The vertices of `other` from number `first` on lie strictly on one side of the plane.
bool on_one_side(const Corners& plane, const Corners& other, int first) {
  const int side = orientation(*plane[0], *plane[1], *plane[2], *other[first]);
  for (int k = first + 1; k < 3 && side != 0; ++k) {
    if (orientation(*plane[0], *plane[1], *plane[2], *other[k]) != side) return false;
  }
  return side != 0;
}

// An edge of `a` that has no shared vertex meets `b`.
bool edge_meets(const Corners& a, const Corners& b, int shared) {
  for (int k = shared == 1 ? 1 : 0; k < (shared == 1 ? 2 : 3); ++k) {
    if (meet(*a[k], *a[(k + 1) % 3], *b[0], *b[1], *b[2])) return true;
  }
  return false;
}

bool clash(const std::vector<Vec3>& points, Triangle first, Triangle second) {
  const int shared = bring_shared_first(first, second);
  const Corners a = corners_of(points, first), b = corners_of(points, second);
  if (shared == 3) return true;
  if (shared == 2) {
    return orientation(*a[0], *a[1], *a[2], *b[2]) == 0 && on_same_side(*a[0], *a[1], *a[2], *b[2]);
  }
  if (on_one_side(a, b, shared) || on_one_side(b, a, shared)) return false;
  return edge_meets(a, b, shared) || edge_meets(b, a, shared);
}

/// What the cut made. Parts of one source need no test against each other.
struct Parts {
  std::vector<Triangle> faces;
  std::vector<int> source;
};

// The triangles of a plane polygon are as good as one: their parts overlap only if one of them is turned. Per region
// face: whether all parts turn the same way, seen along one axis.
std::vector<char> find_flat_faces(const Arrangement& arrangement, const CrackComplex& complex) {
  const Divided& cracks = arrangement.cracks;
  const std::vector<Vec3>& points = arrangement.points.positions();
  std::vector<char> flat;
  for (int begin = 0, end = 0; begin < cracks.face_count(); begin = end) {
    const int polygon = complex.owner[begin].face;
    Vec3 normal = Vec3::Zero();
    for (; end < cracks.face_count() && complex.owner[end].face == polygon; ++end) {
      const Triangle& face = cracks.surface.faces[end];
      normal += (points[face[1]] - points[face[0]]).cross(points[face[2]] - points[face[0]]);
    }
    int axis = 0;
    normal.cwiseAbs().maxCoeff(&axis);
    const int x = (axis + 1) % 3, y = (axis + 2) % 3, turn = sign_of(normal[axis]);
    flat.resize(polygon + 1, false);
    flat[polygon] = true;
    for (int face = begin; face < end && end - begin > 1; ++face) {
      for_each_part(cracks, face, [&](const Triangle& part, int) {
        const Vec3 &a = points[part[0]], &b = points[part[1]], &c = points[part[2]];
        if (planar_orientation(a[x], a[y], b[x], b[y], c[x], c[y]) != turn) flat[polygon] = false;
      });
    }
  }
  return flat;
}

Parts parts_of(const Arrangement& arrangement, const CrackComplex& complex, const std::vector<char>& is_inside) {
  Parts parts;
  const auto add = [&](const Triangle& vertices, int source) {
    parts.faces.push_back(vertices);
    parts.source.push_back(source);
  };
  const Divided &body = arrangement.body, &cracks = arrangement.cracks;
  for (int face = 0; face < body.face_count(); ++face) {
    if (body.patch_of[face] < 0) continue;
    for_each_part(body, face, [&](const Triangle& vertices, int) { add(vertices, face); });
  }
  const std::vector<char> flat = find_flat_faces(arrangement, complex);
  const int first_polygon = body.face_count(), first_triangle = first_polygon + static_cast<int>(flat.size());
  for (int face = 0; face < cracks.face_count(); ++face) {
    const int polygon = complex.owner[face].face;
    const int source = flat[polygon] ? first_polygon + polygon : first_triangle + face;
    for_each_part(cracks, face, [&](const Triangle& vertices, int cell) {
      if (is_inside[cell]) add(vertices, source);
    });
  }
  return parts;
}

TriangleTest around(const std::vector<Vec3>& points, const Triangle& face) {
  return {points[face[0]], points[face[1]], points[face[2]]};
}

}  // namespace

bool intersects_itself(const TriangleMesh& mesh, const BoxTree& tree) {
  std::atomic<bool> found = false;
  tbb::parallel_for(std::size_t{0}, mesh.faces.size(), [&](std::size_t i) {
    if (found.load(std::memory_order_relaxed)) return;
    tree.visit(around(mesh.vertices, mesh.faces[i]), [&](int j) {
      if (j > static_cast<int>(i) && clash(mesh.vertices, mesh.faces[i], mesh.faces[j])) found = true;
    });
  });
  return found;
}

std::vector<char> meeting_faces(const TriangleMesh& mesh, const BoxTree& tree) {
  std::vector<char> meets(mesh.faces.size(), false);
  tbb::parallel_for(std::size_t{0}, mesh.faces.size(), [&](std::size_t i) {
    tree.visit(around(mesh.vertices, mesh.faces[i]), [&](int j) {
      if (j != static_cast<int>(i) && clash(mesh.vertices, mesh.faces[i], mesh.faces[j])) meets[i] = true;
    });
  });
  return meets;
}

void require_embedded(const Arrangement& arrangement, const CrackComplex& complex, const BoxTree& tree,
                      const std::vector<char>& is_inside) {
  const std::vector<Vec3>& points = arrangement.points.positions();
  const Divided& body = arrangement.body;
  const Parts parts = parts_of(arrangement, complex, is_inside);
  const BoxTree own(points, parts.faces);
  tbb::parallel_for(std::size_t{0}, parts.faces.size(), [&](std::size_t i) {
    const Triangle& face = parts.faces[i];
    const auto require = [](bool sound) {
      if (!sound) throw Error(ErrorKind::mesh, "rounded parts meet where they should not");
    };
    require(!collinear(points[face[0]], points[face[1]], points[face[2]]));
    const TriangleTest test = around(points, face);
    own.visit(test, [&](int j) {
      if (j <= static_cast<int>(i) || parts.source[i] == parts.source[j]) return;
      require(!clash(points, face, parts.faces[j]));
    });
    tree.visit(test, [&](int j) {
      if (body.patch_of[j] < 0) require(!clash(points, face, body.surface.faces[j]));
    });
  });
}

}  // namespace sunder::geometry::detail
