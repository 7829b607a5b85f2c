#include "geometry/detail/shells.h"

#include <algorithm>

#include "core/error.h"
#include "geometry/detail/inside.h"

namespace sunder::geometry::detail {
namespace {

// One vertex inside is enough: the shells do not cross, and a vertex where they touch counts as outside.
bool surrounds(const Shell& outer, const Shell& inner) {
  if (!bounds(outer.mesh).contains(bounds(inner.mesh))) return false;
  const InsideTest inside(outer.mesh);
  return std::any_of(inner.mesh.vertices.begin(), inner.mesh.vertices.end(), inside);
}

void append(Shell& outer, const Shell& inner) {
  const int offset = static_cast<int>(outer.mesh.vertices.size());
  outer.mesh.vertices.insert(outer.mesh.vertices.end(), inner.mesh.vertices.begin(), inner.mesh.vertices.end());
  for (const auto& [a, b, c] : inner.mesh.faces) outer.mesh.faces.push_back({a + offset, b + offset, c + offset});
  outer.source.insert(outer.source.end(), inner.source.begin(), inner.source.end());
}

}  // namespace

std::vector<Shell> nest(std::vector<Shell> shells) {
  const auto first_void =
      std::stable_partition(shells.begin(), shells.end(), [](const Shell& shell) { return shell.volume > 0; });
  const std::size_t outer_count = first_void - shells.begin();
  std::vector<int> owner(shells.size(), -1);
  for (std::size_t inner = outer_count; inner < shells.size(); ++inner) {
    if (!(shells[inner].volume < 0)) throw Error(ErrorKind::mesh, "a shell has no volume");
    for (std::size_t outer = 0; outer < outer_count; ++outer) {
      const bool smaller = owner[inner] < 0 || shells[outer].volume < shells[owner[inner]].volume;
      if (smaller && surrounds(shells[outer], shells[inner])) owner[inner] = static_cast<int>(outer);
    }
    if (owner[inner] < 0) throw Error(ErrorKind::mesh, "a void has no shell around it");
  }
  for (std::size_t inner = outer_count; inner < shells.size(); ++inner) {
    append(shells[owner[inner]], shells[inner]);
    shells[owner[inner]].volume += shells[inner].volume;
  }
  shells.resize(outer_count);
  return shells;
}

}  // namespace sunder::geometry::detail
