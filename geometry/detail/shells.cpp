#include "geometry/detail/shells.h"

#include <algorithm>
#include <cstdint>

#include "core/error.h"
#include "geometry/detail/inside.h"
#include "geometry/mass_properties.h"

namespace sunder::geometry::detail {
namespace {

struct Shell {
  Piece piece;
  double volume = 0;  // signed
};

std::vector<Shell> shells(const Piece& surface) {
  const auto neighbours = face_neighbours(surface.mesh);
  std::vector<bool> seen(neighbours.size(), false);
  std::vector<Shell> result;
  for (std::size_t start = 0; start < neighbours.size(); ++start) {
    if (seen[start]) continue;
    std::vector<int> members = {static_cast<int>(start)};
    seen[start] = true;
    for (std::size_t i = 0; i < members.size(); ++i) {
      for (const int next : neighbours[members[i]]) {
        if (!seen[next]) seen[next] = true, members.push_back(next);
      }
    }
    std::sort(members.begin(), members.end());
    Shell shell;
    std::vector<Triangle> faces;
    for (const int face : members) {
      faces.push_back(surface.mesh.faces[face]);
      shell.piece.source.push_back(surface.source[face]);
    }
    shell.piece.mesh = compact(surface.mesh.vertices, faces);
    shell.volume = mass_properties(shell.piece.mesh).volume;
    result.push_back(std::move(shell));
  }
  return result;
}

// One vertex inside is enough: the shells do not cross, and a vertex where they touch counts as outside.
bool surrounds(const TriangleMesh& outer, const TriangleMesh& inner) {
  if (!bounds(outer).contains(bounds(inner))) return false;
  const InsideTest inside(outer);
  return std::any_of(inner.vertices.begin(), inner.vertices.end(), inside);
}

void append(Piece& outer, const Piece& inner) {
  const int offset = static_cast<int>(outer.mesh.vertices.size());
  outer.mesh.vertices.insert(outer.mesh.vertices.end(), inner.mesh.vertices.begin(), inner.mesh.vertices.end());
  for (const auto& [a, b, c] : inner.mesh.faces) outer.mesh.faces.push_back({a + offset, b + offset, c + offset});
  outer.source.insert(outer.source.end(), inner.source.begin(), inner.source.end());
}

bool lexicographically_less(const Vec3& a, const Vec3& b) {
  return std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end());
}

Vec3 lowest_vertex(const Piece& piece) {
  return *std::min_element(piece.mesh.vertices.begin(), piece.mesh.vertices.end(), lexicographically_less);
}

// The smallest outer shell around a void.
int owner_of(const Shell& hole, const std::vector<Shell>& all) {
  int owner = -1;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const bool candidate = all[i].volume > 0 && (owner < 0 || all[i].volume < all[owner].volume);
    if (candidate && surrounds(all[i].piece.mesh, hole.piece.mesh)) owner = static_cast<int>(i);
  }
  if (owner < 0) throw Error(ErrorKind::mesh, "a void has no shell around it");
  return owner;
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

std::vector<Piece> solids(const Piece& surface) {
  std::vector<Shell> all = shells(surface);
  std::vector<int> owner(all.size(), -1);
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (all[i].volume == 0) throw Error(ErrorKind::mesh, "a shell has no volume");
    if (all[i].volume < 0) owner[i] = owner_of(all[i], all);
  }
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (owner[i] >= 0) append(all[owner[i]].piece, all[i].piece);
  }
  std::vector<Piece> result;
  for (Shell& shell : all) {
    if (shell.volume > 0) result.push_back(std::move(shell.piece));
  }
  std::stable_sort(result.begin(), result.end(), [](const Piece& a, const Piece& b) {
    return lexicographically_less(lowest_vertex(a), lowest_vertex(b));
  });
  return result;
}

}  // namespace sunder::geometry::detail
