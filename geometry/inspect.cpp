#include "geometry/inspect.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include <CGAL/Polygon_mesh_processing/self_intersections.h>
#include <boost/iterator/function_output_iterator.hpp>

#include "geometry/detail/cgal_mesh.h"
#include "geometry/detail/clean.h"
#include "geometry/detail/inside.h"
#include "geometry/detail/topology.h"
#include "geometry/mass_properties.h"

namespace sunder::geometry {
namespace {

bool usable(const TriangleMesh& mesh, const Triangle& face) {
  const int count = static_cast<int>(mesh.vertices.size());
  const auto [a, b, c] = face;
  return std::all_of(face.begin(), face.end(),
                     [&](int i) { return i >= 0 && i < count && mesh.vertices[i].allFinite(); }) &&
         a != b && b != c && c != a;
}

bool collinear(const TriangleMesh& mesh, const Triangle& face) {
  const auto point = [&](int corner) { return detail::to_point(mesh.vertices[face[corner]]); };
  return CGAL::collinear(point(0), point(1), point(2));
}

int count_sets(const std::vector<int>& labels) {
  return labels.empty() ? 0 : *std::max_element(labels.begin(), labels.end()) + 1;
}

// Fans of faces around vertices: corners of two faces at the same vertex belong together when the faces share an edge
// there.
int count_pinched_vertices(const std::vector<Triangle>& faces, const std::vector<detail::Side>& sides) {
  detail::DisjointSets corners(3 * static_cast<int>(faces.size()));
  const auto corner_at = [&](const detail::Side& side, int vertex) {
    return 3 * side.face + (faces[side.face][side.corner] == vertex ? side.corner : (side.corner + 1) % 3);
  };
  detail::for_each_edge(sides, [&](auto first, auto last) {
    for (auto side = first + 1; side != last; ++side) {
      corners.unite(corner_at(*first, first->low), corner_at(*side, first->low));
      corners.unite(corner_at(*first, first->high), corner_at(*side, first->high));
    }
  });
  std::vector<std::pair<int, int>> fans;  // (vertex, representative corner)
  for (int i = 0; i < static_cast<int>(3 * faces.size()); ++i) {
    if (corners.find(i) == i) fans.emplace_back(faces[i / 3][i % 3], i);
  }
  std::sort(fans.begin(), fans.end());
  int pinched = 0;
  for (std::size_t i = 1; i < fans.size(); ++i) {
    const bool repeats = fans[i].first == fans[i - 1].first;
    if (repeats && (i == 1 || fans[i - 2].first != fans[i].first)) ++pinched;
  }
  return pinched;
}

void count_edges(MeshReport& report, const std::vector<detail::Side>& sides) {
  std::vector<std::pair<int, int>> boundary;
  detail::for_each_edge(sides, [&](auto first, auto last) {
    if (last - first == 1) boundary.emplace_back(first->low, first->high);
    if (last - first > 2 || (last - first == 2 && first->forward == (first + 1)->forward)) ++report.non_manifold_edges;
  });
  report.boundary_edges = static_cast<int>(boundary.size());
  std::vector<int> ends;
  for (const auto& [a, b] : boundary) ends.insert(ends.end(), {a, b});
  std::sort(ends.begin(), ends.end());
  ends.erase(std::unique(ends.begin(), ends.end()), ends.end());
  const auto index = [&](int vertex) {
    return static_cast<int>(std::lower_bound(ends.begin(), ends.end(), vertex) - ends.begin());
  };
  detail::DisjointSets loops(static_cast<int>(ends.size()));
  for (const auto& [a, b] : boundary) loops.unite(index(a), index(b));
  report.boundary_loops = count_sets(loops.labels());
}

int count_self_intersections(const TriangleMesh& mesh) {
  const detail::SurfaceMesh surface = detail::to_cgal(mesh);
  int count = 0;
  const auto tally = boost::make_function_output_iterator([&](const auto&) { ++count; });
  CGAL::Polygon_mesh_processing::self_intersections(surface, tally);
  return count;
}

// A shell inside an even number of others bounds material on its inner side, one inside an odd number bounds a void.
void count_shells(MeshReport& report, const std::vector<TriangleMesh>& shells) {
  std::vector<int> depth(shells.size(), 0);
  std::vector<Box> boxes;
  for (const TriangleMesh& shell : shells) boxes.push_back(bounds(shell));
  for (std::size_t outer = 0; outer < shells.size(); ++outer) {
    const detail::InsideTest inside(shells[outer]);
    for (std::size_t inner = 0; inner < shells.size(); ++inner) {
      if (inner == outer || !boxes[outer].contains(boxes[inner])) continue;
      depth[inner] += inside(shells[inner].vertices.front());
    }
  }
  for (std::size_t i = 0; i < shells.size(); ++i) {
    const bool outward = mass_properties(shells[i]).volume > 0;
    report.inverted_shells += outward != (depth[i] % 2 == 0);
    report.nested_shells += depth[i] % 2;
  }
}

int count_duplicates(const std::vector<Vec3>& vertices) {
  const std::vector<int> same = detail::coincident(vertices, 0);
  int count = 0;
  for (std::size_t i = 0; i < same.size(); ++i) count += same[i] != static_cast<int>(i);
  return count;
}

std::string counted(int count, const char* one, const char* many) {
  return std::to_string(count) + " " + (count == 1 ? one : many);
}

}  // namespace

bool MeshReport::is_solid() const {
  return faces > 0 && bad_vertices == 0 && boundary_edges == 0 && non_manifold_edges == 0 &&
         non_manifold_vertices == 0 && degenerate_faces == 0 && self_intersections == 0 && inverted_shells == 0 &&
         volume > 0;
}

std::string MeshReport::summary() const {
  if (faces == 0) return "empty: no faces";
  if (is_solid()) return shells == 1 ? "closed solid" : "closed solid of " + std::to_string(shells) + " shells";
  std::string text;
  const auto add = [&](bool condition, const std::string& clause) {
    if (condition) text += (text.empty() ? "" : "; ") + clause;
  };
  add(bad_vertices > 0, counted(bad_vertices, "vertex", "vertices") + " without a finite position");
  add(boundary_edges > 0, "open: " + counted(boundary_edges, "boundary edge", "boundary edges") + " in " +
                              counted(boundary_loops, "hole", "holes"));
  add(non_manifold_edges > 0, counted(non_manifold_edges, "non-manifold edge", "non-manifold edges"));
  add(non_manifold_vertices > 0, counted(non_manifold_vertices, "non-manifold vertex", "non-manifold vertices"));
  add(degenerate_faces > 0, counted(degenerate_faces, "degenerate face", "degenerate faces"));
  add(self_intersections > 0, counted(self_intersections, "self-intersection", "self-intersections"));
  add(duplicate_vertices > 0, counted(duplicate_vertices, "duplicate vertex", "duplicate vertices"));
  add(inverted_shells > 0, counted(inverted_shells, "inverted shell", "inverted shells"));
  add(text.empty(), "no volume");
  return text;
}

MeshReport inspect(const TriangleMesh& mesh) {
  MeshReport report;
  report.vertices = static_cast<int>(mesh.vertices.size());
  report.faces = static_cast<int>(mesh.faces.size());
  TriangleMesh sound{mesh.vertices, {}};
  for (const Triangle& face : mesh.faces) {
    if (usable(mesh, face)) sound.faces.push_back(face);
    report.degenerate_faces += !usable(mesh, face) || collinear(mesh, face);
  }
  report.duplicate_vertices = count_duplicates(mesh.vertices);
  for (Vec3& vertex : sound.vertices) {
    if (vertex.allFinite()) continue;
    ++report.bad_vertices;
    vertex.setZero();  // no sound face uses it
  }
  for (const Vec3& vertex : mesh.vertices) {
    if (vertex.allFinite()) report.box.extend(vertex);
  }
  const std::vector<detail::Side> sides = detail::sorted_sides(sound.faces);
  const std::vector<int> component = detail::face_components(sound.faces, sides);
  report.shells = count_sets(component);
  count_edges(report, sides);
  report.non_manifold_vertices = count_pinched_vertices(sound.faces, sides);
  report.volume = mass_properties(sound).volume;
  const bool surface = report.bad_vertices == 0 && report.degenerate_faces == 0 && report.non_manifold_edges == 0 &&
                       report.non_manifold_vertices == 0;
  report.self_intersections = surface ? count_self_intersections(sound) : -1;
  if (report.self_intersections == 0 && report.boundary_edges == 0) {
    count_shells(report, detail::split(sound, component));
  }
  return report;
}

}  // namespace sunder::geometry
