#include "geometry/cut.h"

#include <algorithm>
#include <cmath>

#include <CGAL/Polygon_mesh_processing/measure.h>
#include <CGAL/Polygon_mesh_processing/orient_polygon_soup.h>
#include <CGAL/Polygon_mesh_processing/orientation.h>
#include <CGAL/Polygon_mesh_processing/polygon_soup_to_polygon_mesh.h>
#include <CGAL/Polygon_mesh_processing/self_intersections.h>

#include "core/random.h"
#include "geometry/detail/body_cut.h"
#include "geometry/detail/cgal_mesh.h"
#include "geometry/detail/shells.h"
#include "geometry/mass_properties.h"

namespace sunder::geometry {
namespace {

namespace pmp = CGAL::Polygon_mesh_processing;
using detail::Kernel;
using detail::SurfaceMesh;
using Point = Kernel::Point_3;

// Cut points that rounding moves across a neighbour, or a crack that touches the body without crossing it, can make a
// fragment invalid. The whole complex is then moved by about this share of its size (regions keep fitting together).
constexpr double kNudge = 1e-6;
constexpr int kAttempts = 4;

[[noreturn]] void reject(const std::string& why) { throw Error(ErrorKind::mesh, why); }

bool has_coincident_points(std::vector<Vec3> points) {
  const auto less = [](const Vec3& a, const Vec3& b) {
    return std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end());
  };
  std::sort(points.begin(), points.end(), less);
  return std::adjacent_find(points.begin(), points.end()) != points.end();
}

bool is_degenerate(const std::vector<Vec3>& vertices, const Triangle& face) {
  return CGAL::collinear(detail::to_point(vertices[face[0]]), detail::to_point(vertices[face[1]]),
                         detail::to_point(vertices[face[2]]));
}

bool has_degenerate_face(const TriangleMesh& mesh) {
  return std::any_of(mesh.faces.begin(), mesh.faces.end(),
                     [&](const Triangle& face) { return is_degenerate(mesh.vertices, face); });
}

// ---- Input ----------------------------------------------------------------------------------------------------

bool indices_in_range(const TriangleMesh& mesh) {
  const int count = static_cast<int>(mesh.vertices.size());
  return std::all_of(mesh.faces.begin(), mesh.faces.end(), [&](const Triangle& face) {
    return std::all_of(face.begin(), face.end(), [&](int vertex) { return vertex >= 0 && vertex < count; });
  });
}

bool all_finite(const std::vector<Vec3>& points) {
  return std::all_of(points.begin(), points.end(), [](const Vec3& x) { return x.allFinite(); });
}

// A vertex where several fans meet: the halfedges around the vertices do not add up to all halfedges.
bool has_non_manifold_vertex(const SurfaceMesh& mesh) {
  std::size_t around = 0;
  for (const auto vertex : mesh.vertices()) around += mesh.is_isolated(vertex) ? 0 : mesh.degree(vertex);
  return around != mesh.number_of_halfedges();
}

// CGAL accepts the outside of a surface as a volume too.
void require_volume(const SurfaceMesh& surface, const std::string& name) {
  if (!pmp::does_bound_a_volume(surface)) reject(name + " does not bound a volume");
  if (!(pmp::volume(surface) > 0)) reject(name + " is inside out or has no volume");
}

// What corefinement asks of its operands and cannot check itself: without it it may hang.
void require_solid(const TriangleMesh& mesh, const SurfaceMesh& surface, const std::string& name) {
  if (!CGAL::is_closed(surface)) reject(name + " is not closed");
  if (has_non_manifold_vertex(surface)) reject(name + " has a vertex where several fans of faces meet");
  if (has_coincident_points(detail::compact(mesh.vertices, mesh.faces).vertices))
    reject(name + " has coincident vertices");
  if (has_degenerate_face(mesh)) reject(name + " has a face without area");
  require_volume(surface, name);
}

SurfaceMesh body_surface(const TriangleMesh& body) {
  if (body.faces.empty()) reject("the body has no faces");
  if (!indices_in_range(body)) reject("a face of the body has a vertex that does not exist");
  if (!all_finite(body.vertices)) reject("the body has a vertex that is not finite");
  SurfaceMesh surface = detail::to_cgal(body);
  require_solid(body, surface, "the body");
  return surface;
}

// The smallest height of the fan's triangles, 0 if one has no area.
double fan_height(const std::vector<Vec3>& vertices, const std::vector<Triangle>& fan) {
  double lowest = std::numeric_limits<double>::infinity();
  for (const Triangle& face : fan) {
    if (is_degenerate(vertices, face)) return 0;
    const Vec3 &a = vertices[face[0]], &b = vertices[face[1]], &c = vertices[face[2]];
    const double longest = std::max({(b - a).norm(), (c - b).norm(), (a - c).norm()});
    lowest = std::min(lowest, (b - a).cross(c - a).norm() / longest);
  }
  return lowest;
}

// The fan whose flattest triangle is the least flat. Empty if every fan has a triangle without area.
std::vector<Triangle> best_fan(const std::vector<Vec3>& vertices, const std::vector<int>& loop) {
  std::vector<Triangle> best;
  double best_height = 0;
  const std::size_t count = loop.size();
  for (std::size_t apex = 0; apex < count && count > 2; ++apex) {
    std::vector<Triangle> fan;
    for (std::size_t i = 1; i + 1 < count; ++i) {
      fan.push_back({loop[apex], loop[(apex + i) % count], loop[(apex + i + 1) % count]});
    }
    const double height = fan_height(vertices, fan);
    if (height > best_height) best_height = height, best = std::move(fan);
  }
  return best;
}

// Every region's triangles, turned outward, over the vertices of the whole complex. A face is triangulated once, for
// both of its regions.
std::vector<std::vector<Triangle>> triangulate(const RegionBoundary& regions) {
  std::vector<std::vector<Triangle>> result(regions.region_count);
  const int vertex_count = static_cast<int>(regions.vertices.size());
  for (const RegionBoundary::Face& face : regions.faces) {
    const auto valid = [&](int vertex) { return vertex >= 0 && vertex < vertex_count; };
    if (!std::all_of(face.loop.begin(), face.loop.end(), valid)) reject("a region face has a missing vertex");
    if (face.inside < 0 || std::max(face.inside, face.outside) >= regions.region_count || face.outside < -1) {
      reject("a region face belongs to a region that does not exist");
    }
    if (face.inside == face.outside) continue;
    const std::vector<Triangle> fan = best_fan(regions.vertices, face.loop);
    if (fan.empty()) reject("a region face has no area");
    for (const auto& [a, b, c] : fan) {
      result[face.inside].push_back({a, b, c});
      if (face.outside >= 0) result[face.outside].push_back({a, c, b});
    }
  }
  return result;
}

SurfaceMesh region_surface(const TriangleMesh& region, const std::string& name) {
  if (region.faces.empty()) return {};
  if (has_coincident_points(region.vertices)) reject(name + " has coincident vertices");
  std::vector<Point> points;
  for (const Vec3& x : region.vertices) points.push_back(detail::to_point(x));
  std::vector<Triangle> faces = region.faces;
  // Gives each fan of faces its own vertex where a region touches itself.
  pmp::orient_polygon_soup(points, faces);
  SurfaceMesh surface;
  if (!pmp::is_polygon_soup_a_polygon_mesh(faces)) reject(name + " is not a manifold surface");
  pmp::polygon_soup_to_polygon_mesh(points, faces, surface);
  if (!CGAL::is_closed(surface)) reject(name + " is not closed");
  require_volume(surface, name);
  return surface;
}

// ---- Output ---------------------------------------------------------------------------------------------------

void require_valid_fragment(const TriangleMesh& mesh) {
  const SurfaceMesh surface = detail::to_cgal(mesh);
  if (!CGAL::is_closed(surface) || has_non_manifold_vertex(surface)) reject("a fragment is open or not manifold");
  if (has_degenerate_face(mesh)) reject("a fragment has a face without area");
  if (pmp::does_self_intersect(surface)) reject("a fragment intersects itself");
}

// ---- All regions ----------------------------------------------------------------------------------------------

using Complex = std::vector<SurfaceMesh>;

Complex build_complex(const RegionBoundary& regions) {
  if (!all_finite(regions.vertices)) reject("a region has a vertex that is not finite");
  Complex complex;
  for (const std::vector<Triangle>& faces : triangulate(regions)) {
    const std::string name = "region " + std::to_string(complex.size());
    complex.push_back(region_surface(detail::compact(regions.vertices, faces), name));
  }
  return complex;
}

Box bounds(const SurfaceMesh& surface) {
  Box box;
  for (const Point& point : surface.points()) box.extend(detail::to_vec3(point));
  return box;
}

// Moves all regions rigidly by about `distance`, differently in every attempt.
void nudge(Complex& complex, int attempt, double distance, const Box& box) {
  const auto random = [&](int index) { return 2 * random_unit(attempt, 0, index) - 1; };
  const Vec3 turn(random(0), random(1), random(2)), offset(random(3), random(4), random(5));
  const Vec3 center = box.center();
  const double radius = box.diagonal().norm() / 2;
  const Mat3 rotation = Eigen::AngleAxisd(turn.norm() * distance / radius, turn.normalized()).toRotationMatrix();
  for (SurfaceMesh& surface : complex) {
    for (Point& point : surface.points()) {
      point = detail::to_point(center + rotation * (detail::to_vec3(point) - center) + offset * distance);
    }
  }
}

std::vector<Fragment> fragments_of(const detail::Piece& piece, int region) {
  std::vector<Fragment> fragments;
  for (detail::Piece& solid : detail::solids(piece)) {
    require_valid_fragment(solid.mesh);
    fragments.push_back({std::move(solid.mesh), std::move(solid.source), region});
  }
  return fragments;
}

std::vector<Fragment> cut_region(const detail::BodyCut& body, const SurfaceMesh& region, int index) {
  try {
    return fragments_of(body.inside(region), index);
  } catch (const std::exception&) {
    // Coplanar faces and the like.
    return fragments_of(body.inside_whole(region), index);
  }
}

CutResult cut_all(const detail::BodyCut& body, const Box& box, const Complex& complex, Progress& progress) {
  CutResult result;
  for (std::size_t region = 0; region < complex.size(); ++region) {
    progress.checkpoint("cut", static_cast<double>(region) / complex.size());
    if (complex[region].is_empty() || !bounds(complex[region]).intersects(box)) continue;
    std::vector<Fragment> fragments = cut_region(body, complex[region], static_cast<int>(region));
    std::move(fragments.begin(), fragments.end(), std::back_inserter(result.fragments));
  }
  progress.checkpoint("cut", 1);
  return result;
}

CutResult refused(CutStatus status, const std::string& detail, double volume_error = 0) {
  return {.status = status, .detail = detail, .fragments = {}, .volume_error = volume_error};
}

CutResult attempt(const detail::BodyCut& body, const Box& box, const Complex& complex, Progress& progress) {
  try {
    return cut_all(body, box, complex, progress);
  } catch (const Error& error) {
    if (error.kind() != ErrorKind::mesh) throw;
    return refused(CutStatus::failed, error.what());
  } catch (const std::exception& error) {  // CGAL: a failed assertion or operands that intersect themselves
    return refused(CutStatus::failed, error.what());
  }
}

CutResult checked_volume(CutResult result, double volume, double tolerance) {
  double sum = 0;
  for (const Fragment& fragment : result.fragments) sum += mass_properties(fragment.mesh).volume;
  result.volume_error = std::abs(sum - volume) / volume;
  if (result.volume_error <= tolerance) return result;
  return refused(CutStatus::volume_lost, "the fragments hold " + std::to_string(sum / volume) + " of the body's volume",
                 result.volume_error);
}

}  // namespace

CutResult cut(const TriangleMesh& body, const RegionBoundary& regions, const CutSettings& settings,
              Progress& progress) {
  SurfaceMesh surface;
  Complex complex;
  try {
    surface = body_surface(body);
    complex = build_complex(regions);
  } catch (const std::exception& error) {
    return refused(CutStatus::bad_input, error.what());
  }
  const detail::BodyCut prepared(body, surface);
  const Box box = bounds(body);
  const double volume = mass_properties(body).volume;
  CutResult result;
  for (int nudges = 0; nudges < kAttempts; ++nudges) {
    if (nudges > 0) nudge(complex, nudges, kNudge * box.diagonal().norm(), box);
    result = attempt(prepared, box, complex, progress);
    if (result.status == CutStatus::ok) result = checked_volume(std::move(result), volume, settings.volume_tolerance);
    result.nudges = nudges;
    if (result.status == CutStatus::ok) return result;
  }
  if (pmp::does_self_intersect(surface)) return refused(CutStatus::bad_input, "the body intersects itself");
  return result;
}

}  // namespace sunder::geometry
