#pragma once
/// The input file (TOML; every key is documented in docs/scene.md).
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/types.h"
#include "geometry/load.h"
#include "mpm/spline.h"
#include "pipeline/effects.h"
#include "pipeline/material.h"
#include "pipeline/motion_path.h"
#include "pipeline/quality.h"
#include "rigid/world.h"

namespace sunder::pipeline {

enum class DamageModel { front, local };
enum class LoadModel { contact, prescribed };
enum class Anchor { base, centre, origin };
enum class RepairMode {
  automatic,  ///< what is not a solid is mended
  off,        ///< what is not a solid is refused
  remesh      ///< remeshed through a level set in any case
};

/// A mesh by catalogue name, as a primitive with its parameters, or as a file.
struct MeshChoice {
  std::string name;             ///< as written in the scene
  std::filesystem::path file;   ///< catalogue file or the path given; empty for primitives
  geometry::LoadSettings load;  ///< unit and up axis
  Vec3 size = Vec3::Zero();     ///< extents of a primitive, or of a file mesh stretched to them; zero: not given
  double height = 0;            ///< uniform scale to this height [m]; 0: not given
  double wall = 0;              ///< wall thickness of hollow primitives [m]; 0: their default
  RepairMode repair = RepairMode::automatic;
  double remesh_voxel = 0;  ///< of the level set [m], after scaling; 0: 1/250 of the diagonal
};

struct SceneBody {
  std::string name;
  MeshChoice mesh;
  Anchor anchor = Anchor::base;
  Vec3 position = Vec3::Zero();  ///< of the anchor [m]
  Quat orientation = Quat::Identity();
  Vec3 velocity = Vec3::Zero();          ///< [m/s]
  Vec3 angular_velocity = Vec3::Zero();  ///< [rad/s]
  Material material;
  bool breakable = true;
  rigid::Motion motion = rigid::Motion::dynamic;
  MotionPath path;                        ///< of a kinematic body; empty: it keeps its velocity
  std::optional<double> minimum_impulse;  ///< instead of the scene's, of the body and its fragments [N s]
  int line = 0;                           ///< of the body in the scene file
};

struct Ground {
  double height = 0;
  Material material;
};

struct FractureSettings {
  std::optional<double>
      minimum_impulse;  ///< [N s]; not set: the impulse whose energy could just open one crack through the body
  /// Bodies under this share of their original body's volume do not break; not set: tiny_volume.
  std::optional<double> minimum_volume;
  int maximum_fractures = 4;          ///< of one original body and all its fragments
  int maximum_fragments = 10000;      ///< once there are so many in the whole scene nothing breaks any more
  double refracture_delay = 0.05;     ///< a fragment cannot break sooner after its birth [s]
  double tiny_volume = 0.05;          ///< share of the original volume under which a fragment is tiny,
  double small_volume = 0.2;          ///< under which it is small,
  double nearly_whole_volume = 0.98;  ///< and from which it is nearly the whole body
  DamageModel damage = DamageModel::front;
  LoadModel load = LoadModel::contact;
  mpm::Spline spline = mpm::Spline::quadratic;
  double node_spacing = 0;     ///< of the lattice on which cracks are found [m]; 0: 0.8 particle spacings
  bool level_set_cut = false;  ///< cut on a voxel grid instead of exactly
  double voxel_size = 0;       ///< of that grid [m]; 0: 1/150 of the body's diagonal
};

enum class TransformTable { off, csv, jsonl, both };

/// What a run writes beside its report; docs/outputs.md describes every file.
struct Outputs {
  bool obj = true;
  bool ply = false;
  bool glb = true;
  bool usd = false;
  TransformTable transforms = TransformTable::off;
  bool fragments_csv = true;       ///< the table of all pieces
  bool vdb = false;                ///< the damage of every solve
  bool page = true;                ///< index.html
  bool poster = true;              ///< poster.png
  bool blender = true;             ///< the script that loads the rest
  std::optional<int> first_frame;  ///< of the files that come one a frame; not set: the scene's
  std::optional<int> last_frame;   ///< with which the run ends; not set: the scene's
  int checkpoint_interval = 10;    ///< frames between two checkpoints; 0: only when the run is stopped
};

/// A value in place of one of the scene file, or beside those: "body.cup.velocity", "[0, -5, 0]".
struct Override {
  std::string key;    ///< "scene.seed", "body.<name>.<key>", "material.<name>.<key>", "fracture.<key>", ...
  std::string value;  ///< as TOML
};

struct Scene {
  std::filesystem::path file;
  std::vector<Override> overrides;  ///< that were read with it
  std::string name;                 ///< file name without extension
  double duration = 2;              ///< [s]
  double frame_rate = 24;           ///< [1/s]
  int start_frame = 1;
  std::uint64_t seed = 1;
  Vec3 gravity = Vec3(0, -9.81, 0);
  Quality quality = Quality::preview;
  std::optional<double> time_budget;  ///< seconds that a run may take; it chooses the quality when it starts
  std::vector<SceneBody> bodies;
  std::optional<Ground> ground;
  FractureSettings fracture;
  EffectSettings effects;
  Outputs outputs;
};

/// Number of the last frame: frames are at multiples of 1 / frame_rate up to the duration, unless outputs end earlier.
int last_frame(const Scene& scene);

/// Where named things live.
struct AssetPaths {
  std::filesystem::path materials;   ///< assets/materials.toml
  std::filesystem::path meshes;      ///< assets/meshes.toml: short name -> file in the cache
  std::filesystem::path mesh_cache;  ///< folder that the bootstrap unpacked the demo meshes into
};

/// The repository's assets; environment variables SUNDER_ASSETS and SUNDER_MESHES override the folders.
AssetPaths default_assets();

/// Reads and checks a scene. Every unknown key, wrong type, missing name and impossible value is an Error (usage; mesh
/// file missing: usage) "file:line: what is wrong; expected ...; did you mean ...?". With overrides the message also
/// lists them, and an override of what the scene does not have (a body, a section) is an error.
Scene load_scene(const std::filesystem::path& file, const AssetPaths& assets = default_assets(),
                 const std::vector<Override>& overrides = {});

/// What repair did to a mesh, and how far that went.
struct MeshRepair {
  std::vector<std::string> steps;  ///< empty: nothing
  bool remeshed = false;
  double volume_before = 0, volume_after = 0;  ///< signed; of an open mesh whatever the sum over its faces gives [m^3]
  double hausdorff = 0;                        ///< distance between the surfaces (geometry::hausdorff_distance) [m]
};

/// Loads or generates the mesh, converts unit and up axis, repairs it (throws ErrorKind::mesh naming body and defect
/// when that fails), scales it, and applies orientation and anchor: the result is in world coordinates at the start of
/// the scene.
struct BodyMesh {
  geometry::TriangleMesh mesh;
  geometry::SurfaceAttributes attributes;  ///< what the file's surface carries; shapes of the program carry nothing
  MeshRepair repair;
  std::string note;  ///< what one should know of how the file was read; empty: nothing
};
BodyMesh body_mesh(const SceneBody& body);

}  // namespace sunder::pipeline
