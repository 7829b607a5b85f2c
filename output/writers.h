#pragma once
/// A sequence as files. Every file is written under a temporary name and renamed, so that what has its final name is
/// whole. All lengths in metres, Y up, unless a format says otherwise. Errors of all: ErrorKind::io with the file and
/// the system's reason, ErrorKind::internal for a pose that is not finite.
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "output/sequence.h"

namespace sunder::output {

/// "0012" for 12, "-0003" for -3: frame numbers in file names have four digits or more.
std::string frame_number(long number);

/// Frames as Wavefront OBJ: `o` per piece, `usemtl` by the surface's materials, `vt` where there is texture, `vn` where
/// the surface has normals, 9 significant digits. An object writes frames of one sequence, in any order; it keeps the
/// text of what the last frame shows, so that only positions and normals are written anew.
class ObjFrames {
 public:
  ObjFrames();
  ~ObjFrames();
  ObjFrames(const ObjFrames&) = delete;
  ObjFrames& operator=(const ObjFrames&) = delete;

  /// File: dir/<name>.<frame number>.obj. Pieces may have been added to the sequence since the last frame.
  void write(const Sequence& sequence, std::size_t frame, const std::filesystem::path& dir);

 private:
  struct Kept;
  std::vector<std::unique_ptr<Kept>> kept_;  ///< by piece, of those that the last frame shows
};

/// dir/<name>.mtl with the materials of all pieces so far.
void write_obj_materials(const Sequence& sequence, const std::filesystem::path& dir);

/// One piece where it was made, as Wavefront OBJ with every digit of its positions: what closed in memory stays closed
/// in the file. Materials as above.
void write_obj_piece(const Piece& piece, const std::filesystem::path& file);

/// One frame as binary PLY, all pieces in one mesh. Per vertex: x, y, z, `piece` (id), `damage_time` (the latest of the
/// corners there [s], -1: none). Per face: `piece`, `source_face` (of the scene's body, -1: on a crack), `inside`,
/// and the colour of its material (sRGB). Comments name the pieces. File: dir/<name>.<frame number>.ply.
void write_ply_frame(const Sequence& sequence, std::size_t frame, const std::filesystem::path& dir);

/// A row or a line for every pose: frame number, time [s], id, name, position [m], orientation (quaternion x, y, z, w),
/// velocity [m/s] and angular velocity about the world's axes [rad/s]. Every digit.
void write_transforms_csv(const Sequence& sequence, const std::filesystem::path& file);
void write_transforms_jsonl(const Sequence& sequence, const std::filesystem::path& file);

/// All of the sequence as USD text: an Xform with a Mesh for each piece, once, with translate and orient sampled at the
/// frames where it is alive, visibility, materials by GeomSubset, primvars st, damage_time and source_face, and
/// `sunder:` attributes for where it comes from and how fast it moves. Time codes are frame numbers.
void write_usda(const Sequence& sequence, const std::filesystem::path& file);

/// All of the sequence as binary glTF 2.0: each piece once, a primitive per material, node translation and rotation
/// sampled at the frames, scale 0 before birth and after death by STEP, `extras` with id, body, parent, generation,
/// birth time and frame, material, volume, mass, areas, closed. Attributes: what the surface has of TEXCOORD_0 and
/// NORMAL (else flat normals are left to the viewer), and _DAMAGE_TIME on crack faces. t = 0 is the first frame.
void write_glb(const Sequence& sequence, const std::filesystem::path& file);

/// dir/import_blender.py, which loads what a run has left beside it (report.json, fragments.glb or the OBJ frames,
/// vdb/) into Blender.
void write_blender_script(const std::filesystem::path& dir);

}  // namespace sunder::output
