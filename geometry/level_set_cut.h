#pragma once
/// Cutting on a voxel grid: rounds edges and loses a little volume, but takes any input.
#include "geometry/cut.h"

namespace sunder::geometry {

struct LevelSetCutSettings {
  double voxel_size = 0;  ///< [m]; 0: 1/150 of the body's diagonal
};

/// The level set of the body, meshed once per region (OpenVDB: narrow bands and dual contouring). Which region a voxel
/// lies in follows from the crack faces between it and its neighbours. Fragments are closed and ordered as those of
/// `cut`, but neighbours do not share faces: `crack_face` and `neighbour` are -1 and every vertex has an id of its own.
/// `source_face` is the nearest face of the body for faces within a voxel of it, else -1. Pieces below 8 voxels are
/// dropped. `volume_error` is the loss; no value of it is refused. The body should be closed; it may intersect itself.
CutResult level_set_cut(const TriangleMesh& body, const RegionBoundary& regions, const LevelSetCutSettings& settings,
                        Progress& progress);

}  // namespace sunder::geometry
