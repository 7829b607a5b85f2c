#include "geometry/detail/body_cut.h"

#include <algorithm>
#include <map>
#include <optional>

#include <CGAL/Polygon_mesh_processing/connected_components.h>
#include <CGAL/Polygon_mesh_processing/corefinement.h>

#include "core/error.h"

namespace sunder::geometry::detail {
namespace {

namespace pmp = CGAL::Polygon_mesh_processing;
using Point = Kernel::Point_3;
using Face = SurfaceMesh::Face_index;
using Vertex = SurfaceMesh::Vertex_index;
using SourceMap = SurfaceMesh::Property_map<Face, int>;
using EdgeMarks = SurfaceMesh::Property_map<SurfaceMesh::Edge_index, bool>;
using Side = CGAL::Side_of_triangle_mesh<SurfaceMesh, Kernel>;

constexpr char kSource[] = "f:source";

// Hands the source of a body face down to its parts. Everything else comes from the region and keeps -1.
struct SourceVisitor : pmp::Corefinement::Default_visitor<SurfaceMesh> {
  SurfaceMesh* body;
  SourceMap source;
  int parent = -1;

  SourceVisitor(SurfaceMesh& surface, SourceMap map) : body(&surface), source(map) {}

  void before_subface_creations(Face split, SurfaceMesh& mesh) { parent = &mesh == body ? source[split] : -1; }
  void after_subface_created(Face created, SurfaceMesh& mesh) {
    if (&mesh == body) source[created] = parent;
  }
  void after_face_copy(Face, const SurfaceMesh&, Face created, SurfaceMesh&) { source[created] = -1; }
};

std::array<Vertex, 3> corners(const SurfaceMesh& mesh, Face face) {
  const auto edge = mesh.halfedge(face);
  return {mesh.source(edge), mesh.target(edge), mesh.target(mesh.next(edge))};
}

EdgeMarks add_marks(SurfaceMesh& mesh) {
  return mesh.add_property_map<SurfaceMesh::Edge_index, bool>("e:cut", false).first;
}

bool is_inside(CGAL::Bounded_side side) { return side == CGAL::ON_BOUNDED_SIDE; }

// The centroid of the component's largest face decides.
bool largest_face_inside(const SurfaceMesh& mesh, const std::vector<Face>& faces, const Side& side) {
  Vec3 centroid = Vec3::Zero();
  double largest = -1;
  for (const Face face : faces) {
    const auto [u, v, w] = corners(mesh, face);
    const Vec3 a = to_vec3(mesh.point(u)), b = to_vec3(mesh.point(v)), c = to_vec3(mesh.point(w));
    const double area = (b - a).cross(c - a).norm();
    if (area > largest) largest = area, centroid = (a + b + c) / 3;
  }
  const CGAL::Bounded_side where = side(to_point(centroid));
  if (where == CGAL::ON_BOUNDARY) throw Error(ErrorKind::mesh, "a patch lies on the other surface");
  return is_inside(where);
}

bool component_inside(const SurfaceMesh& mesh, const std::vector<Face>& faces, std::size_t input_vertices,
                      const Side& side) {
  for (const Face face : faces) {
    for (const Vertex vertex : corners(mesh, face)) {
      if (vertex >= input_vertices) continue;
      const CGAL::Bounded_side where = side(mesh.point(vertex));
      if (where != CGAL::ON_BOUNDARY) return is_inside(where);
    }
  }
  return largest_face_inside(mesh, faces, side);
}

// The faces inside the other surface. No face crosses it: the marked edges are where they meet.
std::vector<Face> faces_inside(SurfaceMesh& mesh, const EdgeMarks& marks, std::size_t input_vertices,
                               const Side& side) {
  const auto component = mesh.add_property_map<Face, std::size_t>("f:component", 0).first;
  const std::size_t count = pmp::connected_components(mesh, component, pmp::parameters::edge_is_constrained_map(marks));
  std::vector<std::vector<Face>> members(count);
  for (const Face face : mesh.faces()) members[component[face]].push_back(face);
  std::vector<Face> result;
  for (const std::vector<Face>& faces : members) {
    if (!component_inside(mesh, faces, input_vertices, side)) continue;
    result.insert(result.end(), faces.begin(), faces.end());
  }
  std::sort(result.begin(), result.end());
  return result;
}

// Collects faces over the body's vertices and those that the cut adds. Both surfaces have bit-equal points along the
// cut, so equal positions are one vertex.
class Collector {
 public:
  explicit Collector(const TriangleMesh& body) : vertices_(body.vertices) {}

  /// Vertices of the body that faces given with positions may use.
  void know(const Triangle& face) {
    for (const int vertex : face) index_.emplace(to_point(vertices_[vertex]), vertex);
  }

  void add(const Triangle& face, int source) {
    faces_.push_back(face);
    source_.push_back(source);
  }
  void add(const SurfaceMesh& mesh, Face face, int source) {
    Triangle triangle;
    const auto vertices = corners(mesh, face);
    for (int k = 0; k < 3; ++k) triangle[k] = index_of(mesh.point(vertices[k]));
    add(triangle, source);
  }

  Piece piece() const { return {compact(vertices_, faces_), source_}; }

 private:
  int index_of(const Point& point) {
    const auto [found, added] = index_.emplace(point, static_cast<int>(vertices_.size()));
    if (added) vertices_.push_back(to_vec3(point));
    return found->second;
  }

  std::vector<Vec3> vertices_;
  std::vector<Triangle> faces_;
  std::vector<int> source_;
  std::map<Point, int> index_;
};

}  // namespace

// A few faces of the body as a surface of their own.
struct BodyCut::Patch {
  SurfaceMesh mesh;
  SourceMap source;
  std::size_t input_vertices = 0;
};

BodyCut::BodyCut(const TriangleMesh& body, const SurfaceMesh& surface)
    : body_(body),
      surface_(surface),
      neighbours_(face_neighbours(body)),
      tree_(surface.faces().begin(), surface.faces().end(), surface),
      side_((tree_.build(), tree_)) {}

std::vector<int> BodyCut::faces_near(const SurfaceMesh& region) const {
  std::vector<Face> hits;
  for (const Face face : region.faces()) {
    const auto [a, b, c] = corners(region, face);
    tree_.all_intersected_primitives(Kernel::Triangle_3(region.point(a), region.point(b), region.point(c)),
                                     std::back_inserter(hits));
  }
  std::vector<bool> near(surface_.num_faces(), false);
  std::vector<Vertex> open;
  const auto take = [&](Face face) {
    if (near[face]) return;
    near[face] = true;
    for (const Vertex vertex : corners(surface_, face)) open.push_back(vertex);
  };
  for (const Face face : hits) take(face);
  while (!open.empty()) {
    const auto around = surface_.halfedges_around_target(surface_.halfedge(open.back()));
    open.pop_back();
    const auto opens_fan = [&](auto edge) {
      return near[surface_.face(edge)] && !near[surface_.face(surface_.opposite(edge))];
    };
    if (std::count_if(around.begin(), around.end(), opens_fan) < 2) continue;
    for (const auto edge : around) take(surface_.face(edge));
  }
  std::vector<int> result;
  for (std::size_t face = 0; face < near.size(); ++face) {
    if (near[face]) result.push_back(static_cast<int>(face));
  }
  return result;
}

BodyCut::Patch BodyCut::patch_of(const std::vector<int>& near) const {
  std::vector<Triangle> faces;
  for (const int face : near) faces.push_back(body_.faces[face]);
  Patch patch;
  patch.mesh = to_cgal(compact(body_.vertices, faces));
  patch.source = patch.mesh.add_property_map<Face, int>(kSource, -1).first;
  for (const Face face : patch.mesh.faces()) patch.source[face] = near[face];
  patch.input_vertices = patch.mesh.num_vertices();
  return patch;
}

// The connected parts of the body that remain without the near faces.
std::vector<std::vector<int>> BodyCut::untouched(const std::vector<int>& near) const {
  std::vector<bool> seen(neighbours_.size(), false);
  for (const int face : near) seen[face] = true;
  std::vector<std::vector<int>> parts;
  for (std::size_t start = 0; start < seen.size(); ++start) {
    if (seen[start]) continue;
    seen[start] = true;
    std::vector<int> part = {static_cast<int>(start)};
    for (std::size_t i = 0; i < part.size(); ++i) {
      for (const int next : neighbours_[part[i]]) {
        if (!seen[next]) seen[next] = true, part.push_back(next);
      }
    }
    parts.push_back(std::move(part));
  }
  return parts;
}

Piece BodyCut::inside(SurfaceMesh region) const {
  const SurfaceMesh whole_region = region;
  const Side region_side(whole_region);
  const std::vector<int> near = faces_near(region);
  Patch patch = patch_of(near);
  const EdgeMarks patch_marks = add_marks(patch.mesh), region_marks = add_marks(region);
  if (!near.empty()) {
    pmp::corefine(patch.mesh, region,
                  pmp::parameters::visitor(SourceVisitor(patch.mesh, patch.source))
                      .edge_is_constrained_map(patch_marks)
                      .throw_on_self_intersection(true),
                  pmp::parameters::edge_is_constrained_map(region_marks));
  }
  Collector collector(body_);
  for (const std::vector<int>& part : untouched(near)) {
    // No face of the part meets the region's surface, so one vertex speaks for all.
    if (!is_inside(region_side(to_point(body_.vertices[body_.faces[part[0]][0]])))) continue;
    for (const int face : part) collector.add(body_.faces[face], face);
  }
  for (const int face : near) collector.know(body_.faces[face]);
  for (const Face face : faces_inside(patch.mesh, patch_marks, patch.input_vertices, region_side)) {
    collector.add(patch.mesh, face, patch.source[face]);
  }
  for (const Face face : faces_inside(region, region_marks, whole_region.num_vertices(), side_)) {
    collector.add(region, face, -1);
  }
  return collector.piece();
}

Piece BodyCut::inside_whole(SurfaceMesh region) const {
  SurfaceMesh part = surface_;
  const SourceMap source = part.add_property_map<Face, int>(kSource, -1).first;
  for (const Face face : part.faces()) source[face] = static_cast<int>(face);
  const bool valid = pmp::corefine_and_compute_intersection(
      part, region, part, pmp::parameters::visitor(SourceVisitor(part, source)).throw_on_self_intersection(true));
  if (!valid) throw Error(ErrorKind::mesh, "the part inside a region is not manifold");
  Piece piece;
  for (const Face face : part.faces()) piece.source.push_back(source[face]);
  piece.mesh = from_cgal(part);
  return piece;
}

}  // namespace sunder::geometry::detail
