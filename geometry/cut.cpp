#include "geometry/cut.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <numeric>

#include <tbb/parallel_for.h>

#include "core/random.h"
#include "geometry/detail/apart.h"
#include "geometry/detail/assemble.h"
#include "geometry/detail/embedding.h"
#include "geometry/detail/predicates.h"
#include "geometry/inspect.h"
#include "geometry/mass_properties.h"

namespace sunder::geometry {
namespace {

using detail::BoxTree;
using detail::CrackComplex;
using detail::Surface;

// A crack that touches the body without crossing it, or a point that rounding moves across a face, stops an attempt.
// The whole complex is then moved by about this share of the body's size (regions keep fitting together).
constexpr double kNudge = 1e-6;
constexpr int kAttempts = 8;

[[noreturn]] void reject(const std::string& why) { throw Error(ErrorKind::mesh, why); }

// ---- Input ----------------------------------------------------------------------------------------------------

bool indices_in_range(const TriangleMesh& mesh) {
  const int count = static_cast<int>(mesh.vertices.size());
  return std::all_of(mesh.faces.begin(), mesh.faces.end(), [&](const Triangle& face) {
    return std::all_of(face.begin(), face.end(), [&](int vertex) { return vertex >= 0 && vertex < count; });
  });
}

bool has_degenerate_face(const TriangleMesh& mesh) {
  return std::any_of(mesh.faces.begin(), mesh.faces.end(), [&](const Triangle& face) {
    return detail::collinear(mesh.vertices[face[0]], mesh.vertices[face[1]], mesh.vertices[face[2]]);
  });
}

bool has_several_shells(const TriangleMesh& mesh, const detail::Edges& edges) {
  detail::DisjointSets sets(static_cast<int>(mesh.faces.size()));
  for (int edge = 0; edge < edges.count(); ++edge) sets.unite(edges.begin(edge)[0].face, edges.begin(edge)[1].face);
  for (int face = 0; face < static_cast<int>(mesh.faces.size()); ++face) {
    if (sets.find(face) != 0) return true;
  }
  return false;
}

/// The body, checked and ready to be cut.
struct Prepared {
  const TriangleMesh& mesh;
  Surface surface;
  BoxTree tree;
  Box box;
  double volume;
};

void require_closed_surface(const TriangleMesh& body) {
  const auto finite = [](const Vec3& x) { return x.allFinite(); };
  if (body.faces.empty()) reject("the body has no faces");
  if (!indices_in_range(body)) reject("a face of the body has a vertex that does not exist");
  if (!std::all_of(body.vertices.begin(), body.vertices.end(), finite)) {
    reject("the body has a vertex that is not finite");
  }
  if (!is_closed_two_manifold(body)) reject("the body is not a closed two-manifold");
  if (has_degenerate_face(body)) reject("the body has a face without area");
}

Prepared prepare(const TriangleMesh& body) {
  Prepared result{body,
                  {body.faces, detail::edges_of(body.faces, static_cast<int>(body.vertices.size()))},
                  BoxTree(body.vertices, body.faces),
                  bounds(body),
                  mass_properties(body).volume};
  if (detail::intersects_itself(body, result.tree)) reject("the body intersects itself");
  if (!(result.volume > 0)) reject("the body is inside out or has no volume");
  if (has_several_shells(body, result.surface.edges) && !inspect(body).is_solid()) {
    reject("the body's shells do not bound a volume");
  }
  return result;
}

// Moves all regions rigidly by about `distance`, differently in every attempt.
void nudge(CrackComplex& complex, int attempt, double distance, const Box& box) {
  const auto random = [&](int index) { return 2 * random_unit(attempt, 0, index) - 1; };
  const Vec3 turn(random(0), random(1), random(2)), offset(random(3), random(4), random(5));
  const Vec3 center = box.center();
  const double radius = box.diagonal().norm() / 2;
  const Mat3 rotation = Eigen::AngleAxisd(turn.norm() * distance / radius, turn.normalized()).toRotationMatrix();
  for (Vec3& x : complex.vertices) x = center + rotation * (x - center) + offset * distance;
}

// ---- One attempt ----------------------------------------------------------------------------------------------

/// Ends all attempts: no nudge can mend the input.
struct BadInput {
  const char* why;
};

std::vector<Fragment> divide_body(const Prepared& body, const CrackComplex& complex, Progress& progress) {
  const Vec3 room = Vec3::Constant(1e-9 * body.box.diagonal().norm());
  const CrackComplex near = detail::part_near(complex, Box(body.box.min() - room, body.box.max() + room));
  std::vector<Vec3> points = body.mesh.vertices;
  const int first = static_cast<int>(points.size());
  points.insert(points.end(), near.vertices.begin(), near.vertices.end());
  Surface cracks{near.triangles, detail::edges_of(near.triangles, static_cast<int>(near.vertices.size()))};
  const detail::Wedges wedges(near, cracks.edges);
  for (Triangle& face : cracks.faces) face = {face[0] + first, face[1] + first, face[2] + first};
  for (auto& [low, high] : cracks.edges.ends) low += first, high += first;
  progress.checkpoint("cut", 0.1);
  const detail::Arrangement arrangement = detail::arrange(points, first, body.surface, body.tree, cracks);
  progress.checkpoint("cut", 0.4);
  const std::vector<char> is_inside = detail::crack_cells_inside(arrangement, body.mesh);
  if (detail::cracks_end_inside(arrangement, wedges, is_inside)) {
    throw BadInput{"the faces around an edge inside the body do not part regions"};
  }
  detail::Labels labels = detail::label(arrangement, near, complex, is_inside);
  progress.checkpoint("cut", 0.5);
  detail::require_embedded(arrangement, near, body.tree, is_inside);
  progress.checkpoint("cut", 0.7);
  return detail::assemble(body.mesh, arrangement, near, wedges, labels);
}

void require_closed(const std::vector<Fragment>& fragments) {
  std::atomic<bool> closed = true;
  tbb::parallel_for(std::size_t{0}, fragments.size(), [&](std::size_t i) {
    if (!is_closed_two_manifold(fragments[i].mesh)) closed = false;
  });
  if (!closed) reject("a fragment is open or not manifold");
}

double volume_of(const std::vector<Fragment>& fragments) {
  std::vector<double> volume(fragments.size());
  tbb::parallel_for(std::size_t{0}, fragments.size(),
                    [&](std::size_t i) { volume[i] = mass_properties(fragments[i].mesh).volume; });
  return std::accumulate(volume.begin(), volume.end(), 0.0);
}

CutResult refused(CutStatus status, const std::string& detail, double volume_error = 0) {
  return {.status = status, .detail = detail, .fragments = {}, .volume_error = volume_error};
}

CutResult attempt(const Prepared& body, const CrackComplex& complex, double tolerance, Progress& progress) {
  try {
    CutResult result;
    result.fragments = divide_body(body, complex, progress);
    progress.checkpoint("cut", 0.8);
    require_closed(result.fragments);
    const double sum = volume_of(result.fragments);
    result.volume_error = std::abs(sum - body.volume) / body.volume;
    if (result.volume_error <= tolerance) return result;
    return refused(CutStatus::volume_lost,
                   "the fragments hold " + std::to_string(sum / body.volume) + " of the body's volume",
                   result.volume_error);
  } catch (const Error& error) {
    if (error.kind() != ErrorKind::mesh) throw;
    return refused(CutStatus::failed, error.what());
  } catch (const BadInput& error) {
    return refused(CutStatus::bad_input, error.why);
  }
}

CutResult cut_prepared(const Prepared& body, const CrackComplex& complex, double tolerance, Progress& progress) {
  CutResult result;
  for (int nudges = 0; nudges < kAttempts; ++nudges) {
    CrackComplex moved = complex;
    if (nudges > 0) nudge(moved, nudges, kNudge * body.box.diagonal().norm(), body.box);
    result = attempt(body, moved, tolerance, progress);
    result.nudges = nudges;
    if (result.status == CutStatus::ok || result.status == CutStatus::bad_input) break;
  }
  progress.checkpoint("cut", 1);
  return result;
}

}  // namespace

CutResult cut(const TriangleMesh& body, const RegionBoundary& regions, const CutSettings& settings,
              Progress& progress) {
  progress.checkpoint("cut", 0);
  try {
    const CrackComplex complex = detail::crack_complex(regions);
    require_closed_surface(body);
    const auto cut_solid = [&](const TriangleMesh& solid) {
      return cut_prepared(prepare(solid), complex, settings.volume_tolerance, progress);
    };
    return detail::has_coincident_vertices(body) ? cut_solid(detail::moved_apart(body)) : cut_solid(body);
  } catch (const Error& error) {
    if (error.kind() != ErrorKind::mesh) throw;
    return refused(CutStatus::bad_input, error.what());
  }
}

}  // namespace sunder::geometry
