#include "geometry/level_set_cut.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "geometry/detail/level_sets.h"
#include "geometry/detail/shells.h"
#include "geometry/detail/topology.h"
#include "geometry/detail/voxel_regions.h"
#include "geometry/mass_properties.h"
#include "geometry/repair.h"

namespace sunder::geometry {
namespace {

constexpr double kVoxels = 150;  // along the diagonal
constexpr int kMargin = 4;       // voxels around the body: its narrow band and one more
constexpr double kDust = 8;      // smallest piece, in voxels

CutResult refused(CutStatus status, const std::string& detail) {
  return {.status = status, .detail = detail, .fragments = {}};
}

detail::Lattice lattice_around(const Box& box, double voxel) {
  detail::Lattice lattice;
  lattice.spacing = voxel;
  // Off the corner by odd shares of a voxel, so that plane faces do not lie in grid planes.
  lattice.origin = box.min() - voxel * (Vec3::Constant(kMargin) + Vec3(0.31, 0.17, 0.43));
  for (int axis = 0; axis < 3; ++axis) {
    lattice.count[axis] = static_cast<int>(std::ceil(box.diagonal()[axis] / voxel)) + 2 * kMargin + 2;
  }
  return lattice;
}

// The crack triangles that bound a region, as a mesh of their own.
TriangleMesh walls_of(const detail::CrackComplex& complex, int region) {
  std::vector<Triangle> faces;
  for (std::size_t i = 0; i < complex.triangles.size(); ++i) {
    const auto& owner = complex.owner[i];
    if (owner.inside == region || owner.outside == region) faces.push_back(complex.triangles[i]);
  }
  return detail::compact(complex.vertices, faces);
}

// Connected solids: outer shells with their voids. Empty when the surface is not closed.
std::vector<TriangleMesh> solids_of(TriangleMesh surface, double smallest) {
  if (surface.faces.empty()) return {};
  if (!is_closed_two_manifold(surface)) surface = repair(surface, {.allow_remesh = false}).mesh;
  if (!is_closed_two_manifold(surface)) throw Error(ErrorKind::mesh, "the surface of a region is not closed");
  const auto component = detail::face_components(surface.faces, detail::sorted_sides(surface.faces));
  std::vector<TriangleMesh> shells = detail::split(surface, component);
  std::erase_if(shells, [&](const TriangleMesh& shell) { return std::abs(mass_properties(shell).volume) < smallest; });
  std::vector<const TriangleMesh*> pointers;
  for (const TriangleMesh& shell : shells) pointers.push_back(&shell);
  const std::vector<int> owner = detail::owners(pointers);
  std::vector<TriangleMesh> result;
  for (std::size_t outer = 0; outer < shells.size(); ++outer) {
    if (owner[outer] != static_cast<int>(outer)) continue;
    result.push_back(shells[outer]);
    for (std::size_t i = 0; i < shells.size(); ++i) {
      if (owner[i] != static_cast<int>(outer) || i == outer) continue;
      const int first = static_cast<int>(result.back().vertices.size());
      result.back().vertices.insert(result.back().vertices.end(), shells[i].vertices.begin(), shells[i].vertices.end());
      for (const auto& [a, b, c] : shells[i].faces) result.back().faces.push_back({a + first, b + first, c + first});
    }
  }
  return result;
}

Fragment fragment_of(TriangleMesh mesh, int region, const detail::BodyLevelSet& level_set, int& next_id) {
  Fragment result;
  result.region = region;
  for (const auto& [a, b, c] : mesh.faces) {
    const Vec3 centroid = (mesh.vertices[a] + mesh.vertices[b] + mesh.vertices[c]) / 3;
    result.source_face.push_back(level_set.face_within_a_voxel(centroid));
  }
  result.crack_face.assign(mesh.faces.size(), -1);
  result.neighbour.assign(mesh.faces.size(), -1);
  result.vertex_id.resize(mesh.vertices.size());
  std::iota(result.vertex_id.begin(), result.vertex_id.end(), next_id);
  next_id += static_cast<int>(mesh.vertices.size());
  result.mesh = std::move(mesh);
  return result;
}

CutResult cut_on_lattice(const TriangleMesh& body, const detail::CrackComplex& complex, int region_count, double voxel,
                         Progress& progress) {
  const detail::Lattice lattice = lattice_around(bounds(body), voxel);
  const detail::BodyLevelSet level_set(body, lattice);
  const std::vector<int> region = detail::voxel_regions(lattice, level_set.near_or_inside(), complex);
  CutResult result;
  int next_id = 0;
  for (int r = 0; r < region_count; ++r) {
    progress.checkpoint("cut", static_cast<double>(r) / region_count);
    const TriangleMesh surface = level_set.part_inside(region, r, walls_of(complex, r));
    for (TriangleMesh& mesh : solids_of(surface, kDust * voxel * voxel * voxel)) {
      result.fragments.push_back(fragment_of(std::move(mesh), r, level_set, next_id));
    }
  }
  progress.checkpoint("cut", 1);
  double sum = 0;
  for (const Fragment& fragment : result.fragments) sum += mass_properties(fragment.mesh).volume;
  const double volume = mass_properties(body).volume;
  result.volume_error = std::abs(sum - volume) / volume;
  return result;
}

}  // namespace

CutResult level_set_cut(const TriangleMesh& body, const RegionBoundary& regions, const LevelSetCutSettings& settings,
                        Progress& progress) {
  progress.checkpoint("cut", 0);
  detail::CrackComplex complex;
  try {
    if (body.faces.empty()) throw Error(ErrorKind::mesh, "the body has no faces");
    complex = detail::crack_complex(regions);
  } catch (const Error& error) {
    return refused(CutStatus::bad_input, error.what());
  }
  const double voxel = settings.voxel_size > 0 ? settings.voxel_size : bounds(body).diagonal().norm() / kVoxels;
  try {
    return cut_on_lattice(body, complex, std::max(1, regions.region_count), voxel, progress);
  } catch (const Error& error) {
    if (error.kind() != ErrorKind::mesh) throw;
    return refused(CutStatus::failed, error.what());
  }
}

}  // namespace sunder::geometry
