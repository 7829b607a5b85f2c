#include "geometry/detail/assemble.h"

#include <algorithm>
#include <numeric>

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include "core/error.h"
#include "geometry/detail/pinches.h"
#include "geometry/detail/shells.h"
#include "geometry/mass_properties.h"

namespace sunder::geometry::detail {
namespace {

// Items are the cells of the body, then both sides of every cell of the cracks.
int item_of(const Arrangement& arrangement, int crack_cell, int side) {
  return arrangement.body.cell_count() + 2 * crack_cell + side;
}

/// Sets of items that hang together: the shells of the fragments.
DisjointSets join(const Arrangement& arrangement, const Wedges& wedges, Labels& labels) {
  const Divided &body = arrangement.body, &cracks = arrangement.cracks;
  DisjointSets sets(body.cell_count() + 2 * cracks.cell_count());
  for (int cell = 0; cell < body.cell_count(); ++cell) sets.unite(cell, labels.body_sets.find(cell));
  for (std::size_t i = 0; i < arrangement.segments.size(); ++i) {
    const int crack = arrangement.crack_cells[i][1];  // the right one is inside the body
    sets.unite(arrangement.body_cells[i][0], item_of(arrangement, crack, 0));
    sets.unite(arrangement.body_cells[i][1], item_of(arrangement, crack, 1));
  }
  for (int edge = 0; edge < cracks.surface.edges.count(); ++edge) {
    const HalfEdge *begin = wedges.begin(edge), *end = wedges.end(edge);
    for (int slot = 0; slot < cracks.slot_count(edge); ++slot) {
      if (!labels.is_inside[cracks.cell_at(*begin, slot)]) continue;
      for (const HalfEdge* here = begin; here != end; ++here) {
        const HalfEdge* next = here + 1 == end ? begin : here + 1;
        sets.unite(item_of(arrangement, cracks.cell_at(*here, slot), here->forward ? 1 : 0),
                   item_of(arrangement, cracks.cell_at(*next, slot), next->forward ? 0 : 1));
      }
    }
  }
  return sets;
}

/// A face of a shell, before it gets vertices of its own.
struct Part {
  Triangle points;
  int source;      // face of the body, or -1
  CrackSide side;  // or triangle -1
  int beyond;      // shell on the other side of the crack, or -1
};

struct Shells {
  std::vector<int> region;               // per shell
  std::vector<std::vector<Part>> parts;  // per shell
};

/// Numbers the shells in the order in which they are met.
class Collector {
 public:
  Collector(const Arrangement& arrangement, const CrackComplex& complex, const Labels& labels, DisjointSets sets)
      : arrangement_(arrangement), complex_(complex), labels_(labels), sets_(std::move(sets)) {
    shell_of_.assign(arrangement.body.cell_count() + 2 * arrangement.cracks.cell_count(), -1);
    number_shells();
    shells_.parts.resize(shells_.region.size());
    for (std::size_t i = 0; i < sizes_.size(); ++i) shells_.parts[i].reserve(sizes_[i]);
    collect();
  }

  Shells take() { return std::move(shells_); }

 private:
  void count(int item, int region) {
    int& shell = shell_of_[sets_.find(item)];
    if (shell < 0) {
      shell = static_cast<int>(shells_.region.size());
      shells_.region.push_back(region);
      sizes_.push_back(0);
    }
    ++sizes_[shell];
  }

  int shell_of(int item) { return shell_of_[sets_.find(item)]; }

  void number_shells() {
    const Divided &body = arrangement_.body, &cracks = arrangement_.cracks;
    for (int face = 0; face < body.face_count(); ++face) {
      for_each_part(body, face, [&](const Triangle&, int cell) { count(cell, labels_.region[cell]); });
    }
    for (int face = 0; face < cracks.face_count(); ++face) {
      for_each_part(cracks, face, [&](const Triangle&, int cell) {
        if (!labels_.is_inside[cell]) return;
        for (const int side : {0, 1}) count(item_of(arrangement_, cell, side), complex_.region({face, side}));
      });
    }
  }

  void collect() {
    const Divided &body = arrangement_.body, &cracks = arrangement_.cracks;
    for (int face = 0; face < body.face_count(); ++face) {
      for_each_part(body, face, [&](const Triangle& points, int cell) {
        shells_.parts[shell_of(cell)].push_back({points, face, {-1, 0}, -1});
      });
    }
    for (int face = 0; face < cracks.face_count(); ++face) {
      for_each_part(cracks, face, [&](const Triangle& points, int cell) {
        if (!labels_.is_inside[cell]) return;
        const int inner = shell_of(item_of(arrangement_, cell, 0)), outer = shell_of(item_of(arrangement_, cell, 1));
        shells_.parts[inner].push_back({points, -1, {face, 0}, outer});
        shells_.parts[outer].push_back({{points[0], points[2], points[1]}, -1, {face, 1}, inner});
      });
    }
  }

  const Arrangement& arrangement_;
  const CrackComplex& complex_;
  const Labels& labels_;
  DisjointSets sets_;
  std::vector<int> shell_of_, sizes_;  // per item that represents a set; per shell
  Shells shells_;
};

/// Every shell as a fragment of its own; `neighbour` holds shells for now.
std::vector<Fragment> meshes_of(const Shells& shells, const Arrangement& arrangement, const CrackComplex& complex,
                                const Wedges& wedges) {
  std::vector<Fragment> result(shells.parts.size());
  const PinchFinder pinches(arrangement, wedges);
  tbb::enumerable_thread_specific<std::vector<int>> index_of(
      [&] { return std::vector<int>(arrangement.points.size(), -1); });
  tbb::parallel_for(std::size_t{0}, shells.parts.size(), [&](std::size_t i) {
    std::vector<int>& index = index_of.local();
    Fragment& out = result[i];
    out.region = shells.region[i];
    const std::size_t count = shells.parts[i].size();
    out.mesh.faces.reserve(count), out.source_face.reserve(count);
    out.crack_face.reserve(count), out.neighbour.reserve(count);
    std::vector<CrackSide> sides;
    for (const Part& part : shells.parts[i]) {
      Triangle face;
      for (int k = 0; k < 3; ++k) {
        int& vertex = index[part.points[k]];
        if (vertex < 0) {
          vertex = static_cast<int>(out.vertex_id.size());
          out.vertex_id.push_back(part.points[k]);
        }
        face[k] = vertex;
      }
      out.mesh.faces.push_back(face);
      out.source_face.push_back(part.source);
      out.crack_face.push_back(part.side.triangle < 0 ? -1 : complex.owner[part.side.triangle].face);
      out.neighbour.push_back(part.beyond);
      sides.push_back(part.side);
    }
    for (const int id : out.vertex_id) index[id] = -1;
    pinches.split(out, sides);
    out.mesh.vertices.reserve(out.vertex_id.size());
    for (const int id : out.vertex_id) out.mesh.vertices.push_back(arrangement.points[id]);
  });
  return result;
}

// Per shell the shell of the solid that it belongs to.
std::vector<int> owners_within_regions(const std::vector<Fragment>& shells) {
  std::vector<int> owner(shells.size()), order(shells.size());
  std::iota(owner.begin(), owner.end(), 0);
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return shells[a].region < shells[b].region; });
  for (std::size_t begin = 0, end = 0; begin < order.size(); begin = end) {
    while (end < order.size() && shells[order[end]].region == shells[order[begin]].region) ++end;
    std::vector<const TriangleMesh*> meshes;
    bool all_outer = true;
    for (std::size_t i = begin; i < end; ++i) {
      meshes.push_back(&shells[order[i]].mesh);
      all_outer &= mass_properties(*meshes.back()).volume > 0;
    }
    if (all_outer) continue;
    const std::vector<int> found = owners(meshes);
    for (std::size_t i = begin; i < end; ++i) owner[order[i]] = order[begin + found[i - begin]];
  }
  return owner;
}

template <typename T>
void append(std::vector<T>& to, const std::vector<T>& from) {
  to.insert(to.end(), from.begin(), from.end());
}

void append(Fragment& outer, const Fragment& inner) {
  const int offset = static_cast<int>(outer.mesh.vertices.size());
  append(outer.mesh.vertices, inner.mesh.vertices);
  for (const auto& [a, b, c] : inner.mesh.faces) outer.mesh.faces.push_back({a + offset, b + offset, c + offset});
  append(outer.source_face, inner.source_face);
  append(outer.crack_face, inner.crack_face);
  append(outer.neighbour, inner.neighbour);
  append(outer.vertex_id, inner.vertex_id);
}

Vec3 lowest_vertex(const Fragment& fragment) {
  const auto less = [](const Vec3& a, const Vec3& b) {
    return std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end());
  };
  return *std::min_element(fragment.mesh.vertices.begin(), fragment.mesh.vertices.end(), less);
}

// The outer shells with their voids, ordered by region and lowest vertex.
std::vector<Fragment> solids(std::vector<Fragment> shells) {
  const std::vector<int> owner = owners_within_regions(shells);
  std::vector<int> order;
  std::vector<Vec3> lowest(shells.size());
  for (std::size_t i = 0; i < shells.size(); ++i) {
    if (owner[i] != static_cast<int>(i)) append(shells[owner[i]], shells[i]);
  }
  for (std::size_t i = 0; i < shells.size(); ++i) {
    if (owner[i] != static_cast<int>(i)) continue;
    order.push_back(static_cast<int>(i));
    lowest[i] = lowest_vertex(shells[i]);
  }
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) {
    if (shells[a].region != shells[b].region) return shells[a].region < shells[b].region;
    return std::lexicographical_compare(lowest[a].begin(), lowest[a].end(), lowest[b].begin(), lowest[b].end());
  });
  std::vector<int> place(shells.size());
  for (std::size_t i = 0; i < order.size(); ++i) place[order[i]] = static_cast<int>(i);
  std::vector<Fragment> result;
  for (const int shell : order) {
    for (int& neighbour : shells[shell].neighbour) neighbour = neighbour < 0 ? -1 : place[owner[neighbour]];
    result.push_back(std::move(shells[shell]));
  }
  return result;
}

Fragment whole(const TriangleMesh& body, int region) {
  Fragment result{
      .mesh = body, .source_face = {}, .region = region, .crack_face = {}, .neighbour = {}, .vertex_id = {}};
  result.source_face.resize(body.faces.size());
  result.vertex_id.resize(body.vertices.size());
  std::iota(result.source_face.begin(), result.source_face.end(), 0);
  std::iota(result.vertex_id.begin(), result.vertex_id.end(), 0);
  result.crack_face.assign(body.faces.size(), -1);
  result.neighbour.assign(body.faces.size(), -1);
  return result;
}

}  // namespace

bool cracks_end_inside(const Arrangement& arrangement, const Wedges& wedges, const std::vector<char>& is_inside) {
  const Divided& cracks = arrangement.cracks;
  for (int edge = 0; edge < cracks.surface.edges.count(); ++edge) {
    if (!wedges.is_loose(edge)) continue;
    for (int slot = 0; slot < cracks.slot_count(edge); ++slot) {
      if (is_inside[cracks.cell_at(*wedges.begin(edge), slot)]) return true;
    }
  }
  return false;
}

std::vector<Fragment> assemble(const TriangleMesh& body, const Arrangement& arrangement, const CrackComplex& complex,
                               const Wedges& wedges, Labels& labels) {
  Collector collector(arrangement, complex, labels, join(arrangement, wedges, labels));
  std::vector<Fragment> fragments = solids(meshes_of(collector.take(), arrangement, complex, wedges));
  const bool untouched =
      fragments.size() == 1 && fragments[0].mesh.faces.size() == body.faces.size() && arrangement.segments.empty();
  if (untouched) return {whole(body, fragments[0].region)};
  return fragments;
}

}  // namespace sunder::geometry::detail
