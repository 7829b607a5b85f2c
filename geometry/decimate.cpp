#include "geometry/decimate.h"

#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/Bounded_normal_change_filter.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/LindstromTurk.h>
#include <CGAL/Surface_mesh_simplification/edge_collapse.h>

#include "core/error.h"
#include "geometry/detail/cgal_mesh.h"

namespace sunder::geometry {
namespace {

namespace simplification = CGAL::Surface_mesh_simplification;
using detail::SurfaceMesh;

constexpr int kTetrahedron = 4;  // faces of the smallest closed surface

/// CGAL's own predicate counts edges.
struct FaceBudget {
  std::size_t most;
  template <typename Cost, typename Profile>
  bool operator()(const Cost&, const Profile& profile, std::size_t, std::size_t) const {
    return profile.surface_mesh().number_of_faces() <= most;
  }
};

}  // namespace

TriangleMesh decimated(const TriangleMesh& solid, int most_faces) {
  if (most_faces < kTetrahedron) throw Error(ErrorKind::usage, "a solid has at least 4 faces");
  if (static_cast<int>(solid.faces.size()) <= most_faces) return solid;
  if (!is_closed_two_manifold(solid))
    throw Error(ErrorKind::mesh, "cannot decimate a mesh that is not closed: repair it first");
  SurfaceMesh mesh = detail::to_cgal(solid);
  const auto policies = CGAL::parameters::get_cost(simplification::LindstromTurk_cost<SurfaceMesh>())
                            .get_placement(simplification::LindstromTurk_placement<SurfaceMesh>())
                            .filter(simplification::Bounded_normal_change_filter<>());
  simplification::edge_collapse(mesh, FaceBudget{static_cast<std::size_t>(most_faces)}, policies);
  mesh.collect_garbage();
  return detail::from_cgal(mesh);
}

}  // namespace sunder::geometry
