#pragma once
/// What a surface carries besides its shape, and how it comes over a cut.
#include <array>
#include <span>
#include <string>
#include <vector>

#include "geometry/cut.h"
#include "geometry/mesh.h"

namespace sunder::geometry {

using Uv = Eigen::Vector2d;
using Colour = Eigen::Vector4d;  ///< red, green, blue, opacity in [0, 1], as the artist's file has them

/// Per face, and per corner in the order of the face. Every list is empty (the surface has no such attribute) or as
/// long as the faces.
struct SurfaceAttributes {
  std::vector<std::array<Uv, 3>> uv;        ///< v grows upward in the picture
  std::vector<std::array<Vec3, 3>> normal;  ///< unit length
  std::vector<int> material;                ///< index into material_names
  std::vector<std::string> material_names;
  std::vector<std::array<Colour, 3>> colour;
  std::vector<std::array<double, 3>> damage_time;  ///< [s]; -1 where unknown

  bool operator==(const SurfaceAttributes&) const = default;
};

/// Whether every list has a length that fits the mesh and every material has a name.
bool fits(const SurfaceAttributes& attributes, const TriangleMesh& mesh);

/// How faces on cracks look.
struct InsideSettings {
  std::string material = "inside";  ///< name of their material
  bool uv = false;                  ///< give them uv also if the body has none
  bool normal = false;              ///< and normals
  /// Per face of the regions the unit normal of the plane that its texture lies on; empty: its own plane. For cracks
  /// that were refined and displaced: with the normals of the faces before, textures have no seams within them.
  std::span<const Vec3> texture_normal = {};
  /// Per vertex of the regions when it was damaged [s], negative: unknown; empty: no times.
  std::span<const double> damage_time = {};
};

/// Per face the unit normal, from `inside` to `outside` (Newell's sum).
std::vector<Vec3> face_normals(const RegionBoundary& regions);

/// The attributes of a fragment that `cut` (or `level_set_cut`) made of the body.
///
/// Faces of the body's surface get what the body has at their corners: at corners of the body's own faces bit for bit,
/// elsewhere by barycentric coordinates in the source face; normals have unit length again. Where the body lacks what
/// inside faces have, they get uv (0, 0), the face's own normal, damage time -1, or a material of the name "outside".
/// Where the body has colours, faces on cracks are white.
///
/// Faces on cracks get
/// * a material that follows those of the body, or the body's material of that name, so that a fragment can be cut
///   again;
/// * if asked or the body has it: uv in metres, (u . x, v . x), of two unit vectors in the plane of the crack face, u
///   level and v upward (towards +Z where the plane is nearly level), right-handed with the normal from the lower to
///   the higher region. Both sides of a crack get the same uv, as the walls of a real crack show the same grain: the
///   side of the higher region therefore sees the texture mirrored. A cut that had to nudge the regions gives uv that
///   are off by the nudge;
/// * if asked or the body has it: the crack face's normal, flat, outward;
/// * the damage time, if any is given: by mean value coordinates (Hormann and Floater, "Mean value coordinates for
///   arbitrary planar polygons", 2006) in the crack face, which are linear along its edges, so neighbouring faces
///   agree; vertices without a time are left out.
/// Inside faces of `level_set_cut` belong to no crack face: their texture lies on the coordinate plane that they are
/// closest to, their normal is their own and their damage time -1.
///
/// A fragment without inside faces has what the body has and nothing more; a body that nothing divides keeps its
/// attributes bit for bit. Errors: ErrorKind::mesh when lists do not fit what they belong to.
SurfaceAttributes carry(const TriangleMesh& body, const SurfaceAttributes& of_body, const Fragment& fragment,
                        const RegionBoundary& regions, const InsideSettings& settings = {});

/// The same attributes on another surface that lies on or near the first, as repair makes it: each face gets what the
/// source has at its corners in the face that is nearest to its centre. A face whose centre is farther than `reach` [m]
/// from the source, such as one that fills a hole, gets uv (0, 0), its own normal, white, no damage time and the
/// material of the nearest face. Errors: ErrorKind::mesh when the attributes do not fit.
SurfaceAttributes transferred(const TriangleMesh& source, const SurfaceAttributes& attributes,
                              const TriangleMesh& target, double reach);

/// After `transformed(mesh, linear, ...)`: normals stay normal to the surface. `linear` must not be a reflection.
void transform_normals(SurfaceAttributes& attributes, const Mat3& linear);

}  // namespace sunder::geometry
