#pragma once
/// What a run produces over time, and how it is written. A sequence is static pieces, each once, and a pose per piece
/// and frame.
#include <filesystem>
#include <limits>
#include <string>
#include <vector>

#include "geometry/mesh.h"
#include "pipeline/scene.h"

namespace sunder::pipeline {

/// A body or fragment that existed at some time.
struct Piece {
  int id = 0;                                                   ///< index in Sequence::pieces
  std::string name;                                             ///< "bunny", "bunny_0007"
  std::string body;                                             ///< name of the scene body it comes from
  int parent = -1;                                              ///< piece id, -1: a body of the scene
  int generation = 0;                                           ///< fractures between it and the scene's body
  double birth_time = 0;                                        ///< [s]
  double death_time = std::numeric_limits<double>::infinity();  ///< when it broke [s]
  geometry::TriangleMesh mesh;                                  ///< in its own frame: origin at the centre of mass
  std::vector<bool> inside;                                     ///< per face: made by a crack
  double volume = 0, area = 0, mass = 0;
  bool closed = false;  ///< a closed two-manifold
  std::string material;
};

struct PiecePose {
  int piece = 0;
  Pose pose;
};

struct Frame {
  double time = 0;               ///< [s]
  std::vector<PiecePose> poses;  ///< of the pieces alive, by piece id
};

struct Sequence {
  std::string name;
  double frame_rate = 24;
  int start_frame = 1;
  std::vector<Piece> pieces;
  std::vector<Frame> frames;
};

/// One frame as Wavefront OBJ, Y-up, metres: `o` per piece, `usemtl <material>_outside` / `<material>_inside`, 9
/// significant digits. File: dir/<name>.<frame number, 4 digits or more>.obj, written under a temporary name and
/// renamed. Also writes the material file dir/<name>.mtl with the first frame. Errors: ErrorKind::io.
void write_obj_frame(const Sequence& sequence, std::size_t frame, const std::filesystem::path& dir);

/// One piece where it was made, as Wavefront OBJ with every digit of its positions: what closed in memory stays closed
/// in the file. Materials as above. Written atomically. Errors: ErrorKind::io.
void write_obj_piece(const Piece& piece, const std::filesystem::path& file);

/// All of the sequence as binary glTF 2.0: each piece once (flat normals are left to the viewer; two primitives:
/// outside, inside), node translation and rotation sampled at the frames, scale 0 before birth and after death by STEP,
/// `extras` with id, parent, generation, birth time, volume, mass. t = 0 is the first frame. Written atomically.
/// Errors: ErrorKind::io.
void write_glb(const Sequence& sequence, const std::filesystem::path& file);

/// With its parents; one that is there is fine. Errors: ErrorKind::io.
void create_folder(const std::filesystem::path& folder);

/// Replaces `file` by `text` through a temporary file in the same folder (rename), so a reader or a full disk never
/// sees half of it. Errors: ErrorKind::io with the system's reason; the temporary file is removed.
void write_atomically(const std::filesystem::path& file, std::string_view bytes);

/// Removes the temporary files that processes left behind which were killed as they wrote to the folder.
void remove_abandoned(const std::filesystem::path& folder);

}  // namespace sunder::pipeline
