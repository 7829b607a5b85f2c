#include "geometry/detail/shells.h"

#include <algorithm>
#include <cstdint>

#include "core/error.h"
#include "geometry/detail/inside.h"
#include "geometry/mass_properties.h"

namespace sunder::geometry::detail {
namespace {

// One vertex inside is enough: the shells do not cross, and a vertex where they touch counts as outside.
bool surrounds(const TriangleMesh& outer, const TriangleMesh& inner) {
  if (!bounds(outer).contains(bounds(inner))) return false;
  const InsideTest inside(outer);
  return std::any_of(inner.vertices.begin(), inner.vertices.end(), inside);
}

}  // namespace

std::vector<std::array<int, 3>> face_neighbours(const TriangleMesh& mesh) {
  struct Side {
    std::uint64_t edge;  // lower and higher vertex
    int face, corner;
    bool rising;
  };
  std::vector<Side> sides;
  sides.reserve(mesh.faces.size() * 3);
  for (std::size_t face = 0; face < mesh.faces.size(); ++face) {
    for (int k = 0; k < 3; ++k) {
      const auto [low, high] = std::minmax({mesh.faces[face][k], mesh.faces[face][(k + 1) % 3]});
      const auto edge = static_cast<std::uint64_t>(low) << 32 | static_cast<std::uint64_t>(high);
      sides.push_back({edge, static_cast<int>(face), k, mesh.faces[face][k] == low});
    }
  }
  std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) { return a.edge < b.edge; });
  std::vector<std::array<int, 3>> result(mesh.faces.size());
  for (std::size_t i = 0; i < sides.size(); i += 2) {
    const bool paired = i + 1 < sides.size() && sides[i].edge == sides[i + 1].edge &&
                        sides[i].rising != sides[i + 1].rising &&
                        (i + 2 == sides.size() || sides[i + 2].edge != sides[i].edge);
    if (!paired) throw Error(ErrorKind::mesh, "an edge does not have exactly two faces in opposite directions");
    result[sides[i].face][sides[i].corner] = sides[i + 1].face;
    result[sides[i + 1].face][sides[i + 1].corner] = sides[i].face;
  }
  return result;
}

TriangleMesh compact(const std::vector<Vec3>& vertices, const std::vector<Triangle>& faces) {
  TriangleMesh mesh;
  mesh.faces.reserve(faces.size());
  std::vector<int> index(vertices.size(), -1);
  for (Triangle face : faces) {
    for (int& vertex : face) {
      if (index[vertex] < 0) {
        index[vertex] = static_cast<int>(mesh.vertices.size());
        mesh.vertices.push_back(vertices[vertex]);
      }
      vertex = index[vertex];
    }
    mesh.faces.push_back(face);
  }
  return mesh;
}

std::vector<int> owners(const std::vector<const TriangleMesh*>& shells) {
  std::vector<double> volume;
  for (const TriangleMesh* shell : shells) volume.push_back(mass_properties(*shell).volume);
  std::vector<int> result(shells.size());
  for (std::size_t i = 0; i < shells.size(); ++i) {
    if (volume[i] == 0) throw Error(ErrorKind::mesh, "a shell has no volume");
    result[i] = volume[i] > 0 ? static_cast<int>(i) : -1;
    if (volume[i] > 0) continue;
    for (std::size_t outer = 0; outer < shells.size(); ++outer) {
      const bool candidate = volume[outer] > 0 && (result[i] < 0 || volume[outer] < volume[result[i]]);
      if (candidate && surrounds(*shells[outer], *shells[i])) result[i] = static_cast<int>(outer);
    }
    if (result[i] < 0) throw Error(ErrorKind::mesh, "a void has no shell around it");
  }
  return result;
}

}  // namespace sunder::geometry::detail
