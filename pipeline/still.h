#pragma once
/// One body, broken where it stands: no scene, no motion.
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/progress.h"
#include "pipeline/cracking.h"
#include "pipeline/material.h"
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
  double severity = 0;            ///< instead of it, as a multiple of breaking_impulse
  double speed = 10;              ///< of the impactor [m/s]
  int cells = 0;                  ///< no impact: a plain Voronoi shatter of so many cells
};

struct ExtractOptions : StillOptions {
  std::filesystem::path points;  ///< see geometry::load_points
};

/// A body with its mesh as it is broken.
struct StillBody {
  SceneBody body;
  BodyMesh source;
};

/// Errors: ErrorKind::usage for an unknown material, ErrorKind::mesh, ErrorKind::io.
StillBody load_still_body(const FractureOptions& options);

/// The impact of a hit, as it was solved.
struct StillImpact {
  Vec3 at = Vec3::Zero();         ///< on the surface [m]
  Vec3 direction = Vec3::Zero();  ///< of the impactor's flight, of unit length
  double impulse = 0;             ///< the momentum that it brings [N s]
  double speed = 0;               ///< [m/s]
  double energy = 0;              ///< kinetic, of the impactor [J]
};

struct StillResult {
  output::Sequence sequence;  ///< a single frame; pieces in the coordinates of the mesh
  Report report;
  crack::Extraction cracks;           ///< no faces where nothing cracked, or for a shatter into cells
  std::optional<StillImpact> impact;  ///< of a hit
};

/// The momentum [N s] of an impactor of this speed [m/s] whose collision with the body could just open one crack
/// through it: the reduced mass's kinetic energy is crack_through_energy, as at the threshold of a scene.
double breaking_impulse(double mass, double volume, const Material& material, double speed);

/// fracture_mesh without files, of a body that is loaded: options' mesh, unit, axis, size and material are not read
/// again. Errors: as fracture_mesh but those of loading.
StillResult break_still_body(const StillBody& body, const FractureOptions& options, Progress& progress);

/// One solve of one body that nothing holds, hit by a ball; or a shatter into Voronoi cells of random points in it.
/// Writes fragments/<name>_####.obj (every digit), fragments.glb, cracks.ply (not for cells) and report.json. A body
/// that stays whole is its own only piece. Errors: ErrorKind::usage, ErrorKind::mesh, ErrorKind::unstable,
/// ErrorKind::io.
StillResult fracture_mesh(const FractureOptions& options, Progress& progress);

/// Crack surfaces of any cloud of damaged points, and with a mesh the pieces that they cut it into. Writes cracks.ply
/// and report.json, and with a mesh the same files as fracture_mesh. Errors: as there.
StillResult extract_points(const ExtractOptions& options, Progress& progress);

}  // namespace sunder::pipeline
