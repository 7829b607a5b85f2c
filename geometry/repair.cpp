#include "geometry/repair.h"

#include <array>
#include <cstdio>

#include "geometry/detail/clean.h"
#include "geometry/detail/mend.h"
#include "geometry/detail/remesh.h"
#include "geometry/detail/topology.h"
#include "geometry/mass_properties.h"

namespace sunder::geometry {
namespace {

using detail::Steps;

// Dual contouring can leave a pinched spot at one voxel size and none at another: these shares are tried in turn.
constexpr std::array kVoxelShares = {1.0, 0.93, 0.86};
// Bubbles of the level set below this many voxels are noise.
constexpr double kBubble = 64;

TriangleMesh closed_surface(const TriangleMesh& mesh, Steps& steps) {
  return detail::with_holes_filled(detail::as_manifold(mesh, steps), steps);
}

TriangleMesh without_bubbles(const TriangleMesh& mesh, double voxel) {
  TriangleMesh result;
  const std::vector<int> component = detail::face_components(mesh.faces, detail::sorted_sides(mesh.faces));
  for (const TriangleMesh& shell : detail::split(mesh, component)) {
    if (std::abs(mass_properties(shell).volume) < kBubble * voxel * voxel * voxel) continue;
    const int first = static_cast<int>(result.vertices.size());
    result.vertices.insert(result.vertices.end(), shell.vertices.begin(), shell.vertices.end());
    for (const auto& [a, b, c] : shell.faces) result.faces.push_back({first + a, first + b, first + c});
  }
  return result;
}

std::string remesh_step(double voxel) {
  std::array<char, 64> text;
  std::snprintf(text.data(), text.size(), "remeshed through a level set (voxel %.3g m)", voxel);
  return text.data();
}

void take(RepairResult& result, const TriangleMesh& mesh, const MeshReport& report, const Steps& steps) {
  result.mesh = mesh;
  result.after = report;
  result.steps.insert(result.steps.end(), steps.begin(), steps.end());
  result.solid = report.is_solid();
}

void remesh(RepairResult& result, const TriangleMesh& source, const RepairSettings& settings) {
  const double diagonal = bounds(source).diagonal().norm();
  for (const double share : kVoxelShares) {
    const double voxel = share * settings.remesh_voxel * diagonal;
    Steps steps = {remesh_step(voxel)};
    TriangleMesh mesh = without_bubbles(detail::remeshed(source, voxel), voxel);
    if (mesh.faces.empty()) break;
    MeshReport report = inspect(mesh);
    if (!report.is_solid()) {
      mesh = detail::outward(closed_surface(mesh, steps), steps);
      report = inspect(mesh);
    }
    if (!report.is_solid()) continue;
    result.remeshed = true;
    return take(result, mesh, report, steps);
  }
  result.steps.push_back("remeshing through a level set gave no solid");
}

}  // namespace

RepairResult repair(const TriangleMesh& mesh, const RepairSettings& settings) {
  RepairResult result;
  result.before = inspect(mesh);
  take(result, mesh, result.before, {});
  if (result.solid && !settings.force_remesh) return result;
  Steps steps;
  const TriangleMesh clean = detail::cleaned(mesh, steps);
  if (clean.faces.empty()) return take(result, clean, inspect(clean), steps), result;
  const TriangleMesh closed = closed_surface(clean, steps);
  const TriangleMesh mended = detail::outward(detail::without_crossings(closed, steps), steps);
  take(result, mended, inspect(mended), steps);
  if (settings.force_remesh || (!result.solid && settings.allow_remesh)) remesh(result, closed, settings);
  return result;
}

}  // namespace sunder::geometry
