#pragma once
/// What a run produces over time: static pieces, each once, and a pose per piece and frame.
#include <limits>
#include <string>
#include <vector>

#include "core/types.h"
#include "geometry/attributes.h"
#include "geometry/mesh.h"

namespace sunder::output {

/// A body or fragment that existed at some time.
struct Piece {
  int id = 0;                                                   ///< index in Sequence::pieces
  std::string name;                                             ///< "bunny", "bunny_0007"
  std::string body;                                             ///< name of the scene body it comes from
  int parent = -1;                                              ///< piece id, -1: a body of the scene
  int generation = 0;                                           ///< fractures between it and the scene's body
  double birth_time = 0;                                        ///< [s]
  double death_time = std::numeric_limits<double>::infinity();  ///< when it broke [s]
  Vec3 birth_position = Vec3::Zero();                           ///< of its centre of mass at birth [m]
  Twist birth;                                                  ///< its motion at birth
  double birth_energy = 0;                                      ///< kinetic, of that motion [J]
  geometry::TriangleMesh mesh;                                  ///< in its own frame: origin at the centre of mass
  std::vector<int> source_face;         ///< per face: the face of the scene's body that it is a part of; -1: on a crack
  geometry::SurfaceAttributes surface;  ///< fits the mesh, with a material for every face
  double volume = 0, area = 0, mass = 0;
  double inside_area = 0;  ///< of the faces on cracks [m^2]
  bool closed = false;     ///< a closed two-manifold
  std::string material;    ///< of its substance: "glass"

  bool inside(std::size_t face) const { return source_face[face] < 0; }
};

struct PiecePose {
  int piece = 0;
  Pose pose;
  Twist twist;
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

/// Number of the first frame at or after a time.
int frame_at(double time, double frame_rate, int start_frame);

/// "bunny_0007".
std::string fragment_name(const std::string& body, int number);

/// Names of the surfaces of a substance where the artist's file names none: "glass_outside", "glass_inside".
std::string outside_material(const std::string& material);
std::string inside_material(const std::string& material);

}  // namespace sunder::output
