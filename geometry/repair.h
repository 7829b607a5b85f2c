#pragma once
/// Making a solid out of a broken mesh, or saying why not.
#include <string>
#include <vector>

#include "geometry/inspect.h"
#include "geometry/mesh.h"

namespace sunder::geometry {

struct RepairSettings {
  /// Voxel size of the last resort, remeshing through a level set, as a share of the bounding box diagonal.
  double remesh_voxel = 1.0 / 250;
  /// Allow the last resort. It rounds sharp edges and changes the surface by up to about a voxel.
  bool allow_remesh = true;
  /// Take the last resort in any case, also for a solid: for even meshes, or to unite what only touches.
  bool force_remesh = false;
};

struct RepairResult {
  bool solid = false;              ///< `mesh` is a closed, oriented solid without self-intersections
  TriangleMesh mesh;               ///< the best that was reached, also when not solid
  std::vector<std::string> steps;  ///< what was done, in order, e.g. "filled 1 hole (56 edges)"; empty: nothing to do
  MeshReport before, after;
  bool remeshed = false;  ///< the last resort was taken
};

/// Weld, drop degenerate faces, split non-manifold vertices, orient, fill holes, unite shells that cross each other,
/// remove other self-intersections (CGAL polygon mesh processing); what that cannot mend is remeshed through an OpenVDB
/// level set. A mesh that is a solid is returned bit-identical.
RepairResult repair(const TriangleMesh& mesh, const RepairSettings& settings = {});

}  // namespace sunder::geometry
