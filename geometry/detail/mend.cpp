// CGAL checks that it hopes for, not ones that it needs, would flood the terminal.
#define CGAL_NO_WARNINGS

#include "geometry/detail/mend.h"

#include <algorithm>
#include <exception>
#include <iterator>
#include <map>
#include <set>

#include <CGAL/Polygon_mesh_processing/border.h>
#include <CGAL/Polygon_mesh_processing/connected_components.h>
#include <CGAL/Polygon_mesh_processing/corefinement.h>
#include <CGAL/Polygon_mesh_processing/orient_polygon_soup.h>
#include <CGAL/Polygon_mesh_processing/orientation.h>
#include <CGAL/Polygon_mesh_processing/polygon_soup_to_polygon_mesh.h>
#include <CGAL/Polygon_mesh_processing/repair_degeneracies.h>
#include <CGAL/Polygon_mesh_processing/repair_self_intersections.h>
#include <CGAL/Polygon_mesh_processing/self_intersections.h>
#include <CGAL/Polygon_mesh_processing/stitch_borders.h>
#include <CGAL/Polygon_mesh_processing/triangulate_hole.h>

#include "geometry/detail/cgal_mesh.h"
#include "geometry/detail/topology.h"
#include "geometry/mass_properties.h"

namespace sunder::geometry::detail {
namespace {

namespace pmp = CGAL::Polygon_mesh_processing;
namespace np = CGAL::parameters;

using Face = SurfaceMesh::Face_index;
using Halfedge = SurfaceMesh::Halfedge_index;
using FacePairs = std::vector<std::pair<Face, Face>>;

// Holes with more edges are filled from their Delaunay triangulation only: the exhaustive search is cubic.
constexpr std::size_t kCubicLimit = 300;
// Patching crossings one by one is slow and is for a few of them: beyond these bounds the shape itself is in doubt.
constexpr double kCrossingShare = 0.25;  // of all faces
constexpr std::size_t kMostCrossings = 2000;

// CGAL reports a broken precondition or a dead end by an exception; the mesh that went in is then still the best there
// is.
template <class Operation>
TriangleMesh attempt(const TriangleMesh& mesh, Steps& steps, const std::string& name, const Operation& operation) {
  try {
    return operation();
  } catch (const std::exception&) {
    steps.push_back(name + " failed");
    return mesh;
  }
}

SurfaceMesh manifold_surface(const TriangleMesh& mesh, Steps& steps) {
  std::vector<Kernel::Point_3> points;
  std::vector<std::vector<std::size_t>> polygons;
  for (const Vec3& vertex : mesh.vertices) points.push_back(to_point(vertex));
  for (const auto& [a, b, c] : mesh.faces) polygons.push_back({std::size_t(a), std::size_t(b), std::size_t(c)});
  pmp::orient_polygon_soup(points, polygons);
  if (points.size() > mesh.vertices.size()) {
    steps.push_back(
        step("split", points.size() - mesh.vertices.size(), "non-manifold vertex", "non-manifold vertices"));
  }
  SurfaceMesh surface;
  pmp::polygon_soup_to_polygon_mesh(points, polygons, surface);
  return surface;
}

std::size_t border_length(const SurfaceMesh& surface, Halfedge border) {
  std::size_t count = 0;
  Halfedge at = border;
  do ++count;
  while ((at = surface.next(at)) != border);
  return count;
}

FacePairs crossings(const SurfaceMesh& surface) {
  FacePairs pairs;
  pmp::self_intersections(surface, std::back_inserter(pairs));
  return pairs;
}

// The shells of the surface, each turned outward, and for each the group of shells that it crosses, directly or through
// others.
struct Shells {
  std::vector<SurfaceMesh> meshes;
  std::vector<int> group;
};

// Empty when a shell crosses itself or is open.
Shells shells_that_cross(const TriangleMesh& mesh, const FacePairs& pairs) {
  const std::vector<int> component = face_components(mesh.faces, sorted_sides(mesh.faces));
  Shells shells;
  for (const TriangleMesh& part : split(mesh, component)) {
    SurfaceMesh& shell = shells.meshes.emplace_back(to_cgal(part));
    if (!CGAL::is_closed(shell)) return {};
    if (!pmp::is_outward_oriented(shell)) pmp::reverse_face_orientations(shell);
  }
  DisjointSets groups(static_cast<int>(shells.meshes.size()));
  for (const auto& [a, b] : pairs) {
    if (component[a] == component[b]) return {};
    groups.unite(component[a], component[b]);
  }
  shells.group = groups.labels();
  return shells;
}

// Whether two shells have an edge's ends in common.
bool share_an_edge(const SurfaceMesh& a, const SurfaceMesh& b) {
  std::set<Kernel::Point_3> points;
  for (const auto vertex : a.vertices()) points.insert(a.point(vertex));
  int shared = 0;
  for (const auto vertex : b.vertices()) shared += points.contains(b.point(vertex)) ? 1 : 0;
  return shared >= 2;
}

// False when CGAL cannot represent the union as a manifold surface.
bool unite_groups(Shells& shells) {
  // On anything else corefinement may never end, and neither does it on some shells that share edges.
  const auto is_volume = [](const SurfaceMesh& shell) {
    return CGAL::is_closed(shell) && pmp::does_bound_a_volume(shell);
  };
  std::map<int, std::size_t> first;
  for (std::size_t i = 0; i < shells.meshes.size(); ++i) {
    if (!is_volume(shells.meshes[i])) return false;
    const auto [entry, is_new] = first.try_emplace(shells.group[i], i);
    if (is_new) continue;
    SurfaceMesh& sum = shells.meshes[entry->second];
    SurfaceMesh united;
    if (share_an_edge(sum, shells.meshes[i])) return false;
    if (!pmp::corefine_and_compute_union(sum, shells.meshes[i], united, np::throw_on_self_intersection(true)))
      return false;
    sum = std::move(united);
    shells.meshes[i].clear();
  }
  return true;
}

TriangleMesh joined(const std::vector<SurfaceMesh>& meshes) {
  TriangleMesh result;
  for (const SurfaceMesh& mesh : meshes) {
    const TriangleMesh part = from_cgal(mesh);
    const int first = static_cast<int>(result.vertices.size());
    result.vertices.insert(result.vertices.end(), part.vertices.begin(), part.vertices.end());
    for (const auto& [a, b, c] : part.faces) result.faces.push_back({first + a, first + b, first + c});
  }
  return result;
}

}  // namespace

TriangleMesh as_manifold(const TriangleMesh& mesh, Steps& steps) {
  return attempt(mesh, steps, "turning the faces", [&] {
    SurfaceMesh surface = manifold_surface(mesh, steps);
    pmp::stitch_borders(surface, np::apply_per_connected_component(true));
    pmp::stitch_borders(surface);
    const std::size_t before = surface.number_of_faces();
    pmp::remove_degenerate_faces(surface);
    const std::size_t after = surface.number_of_faces();
    if (after < before) steps.push_back(step("removed", before - after, "face of zero area", "faces of zero area"));
    return from_cgal(surface);
  });
}

TriangleMesh with_holes_filled(const TriangleMesh& mesh, Steps& steps) {
  return attempt(mesh, steps, "filling holes", [&] {
    SurfaceMesh surface = to_cgal(mesh);
    std::vector<Halfedge> holes;
    pmp::extract_boundary_cycles(surface, std::back_inserter(holes));
    std::size_t filled = 0, edges = 0;
    for (const Halfedge hole : holes) {
      const std::size_t length = border_length(surface, hole);
      std::vector<Face> faces;
      std::vector<SurfaceMesh::Vertex_index> vertices;
      pmp::triangulate_and_refine_hole(surface, hole, std::back_inserter(faces), std::back_inserter(vertices),
                                       np::do_not_use_cubic_algorithm(length > kCubicLimit));
      if (faces.empty()) continue;
      ++filled;
      edges += length;
    }
    if (filled > 0) steps.push_back(step("filled", filled, "hole", "holes") + " (" + std::to_string(edges) + " edges)");
    if (filled < holes.size()) steps.push_back(step("could not fill", holes.size() - filled, "hole", "holes"));
    return from_cgal(surface);
  });
}

TriangleMesh without_crossings(const TriangleMesh& mesh, Steps& steps) {
  return attempt(mesh, steps, "removing self-intersections", [&] {
    SurfaceMesh surface = to_cgal(mesh);
    const FacePairs pairs = crossings(surface);
    if (pairs.empty()) return mesh;
    Shells shells = shells_that_cross(mesh, pairs);
    const std::size_t count = shells.meshes.size();
    if (count > 1 && unite_groups(shells)) {
      steps.push_back(step("united", count, "shell", "shells that cross"));
      return joined(shells.meshes);
    }
    const double most = std::min<double>(kMostCrossings, kCrossingShare * mesh.faces.size());
    if (pairs.size() > most) return mesh;
    if (!pmp::experimental::remove_self_intersections(surface)) return mesh;
    steps.push_back(step("removed", pairs.size(), "self-intersection", "self-intersections"));
    return from_cgal(surface);
  });
}

TriangleMesh outward(const TriangleMesh& mesh, Steps& steps) {
  return attempt(mesh, steps, "orienting", [&] {
    if (mesh.faces.empty()) return mesh;
    SurfaceMesh surface = to_cgal(mesh);
    const bool oriented = mass_properties(mesh).volume > 0 && pmp::does_bound_a_volume(surface);
    if (oriented || !CGAL::is_closed(surface)) return mesh;
    pmp::orient_to_bound_a_volume(surface);
    steps.push_back("turned shells to bound a volume");
    return from_cgal(surface);
  });
}

}  // namespace sunder::geometry::detail
