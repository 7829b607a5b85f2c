#pragma once
/// One body, broken where it stands: no scene, no motion.
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/progress.h"
#include "pipeline/cracking.h"
#include "pipeline/report.h"
#include "pipeline/scene.h"

namespace sunder::pipeline {

/// The mesh of `fracture` and `extract`, and what they share.
struct StillOptions {
  std::filesystem::path mesh;   ///< a file or a name of the catalogue; may be empty for `extract`
  geometry::LoadSettings load;  ///< unit and up axis of the file
  double height = 0;            ///< scale the mesh to this height [m]; 0: as it is
  std::filesystem::path out;    ///< folder for the results; created when missing
  FractureSettings fracture;    ///< of how cracks are found and cut
  EffectSettings effects;
  std::uint64_t seed = 1;
};

struct FractureOptions : StillOptions {
  std::string material = "glass";
  Quality quality = Quality::preview;
  std::optional<Vec3> at;         ///< where it is hit: the nearest point of the surface [m]
  std::optional<Vec3> direction;  ///< of the impactor; not set: against the surface
  double impulse = 0;             ///< momentum of the impactor, a steel ball [N s]
  double speed = 10;              ///< of the impactor [m/s]
  int cells = 0;                  ///< no impact: a plain Voronoi shatter of so many cells
};

struct ExtractOptions : StillOptions {
  std::filesystem::path points;  ///< see geometry::load_points
};

struct StillResult {
  output::Sequence sequence;  ///< a single frame; pieces in the coordinates of the mesh
  Report report;
};

/// One solve of one body that nothing holds, hit by a ball; or a shatter into Voronoi cells of random points in it.
/// Writes fragments/<name>_####.obj (every digit), fragments.glb, cracks.ply (not for cells) and report.json. A body
/// that stays whole is its own only piece. Errors: ErrorKind::usage, ErrorKind::mesh, ErrorKind::unstable,
/// ErrorKind::io.
StillResult fracture_mesh(const FractureOptions& options, Progress& progress);

/// Crack surfaces of any cloud of damaged points, and with a mesh the pieces that they cut it into. Writes cracks.ply
/// and report.json, and with a mesh the same files as fracture_mesh. Errors: as there.
StillResult extract_points(const ExtractOptions& options, Progress& progress);

}  // namespace sunder::pipeline
