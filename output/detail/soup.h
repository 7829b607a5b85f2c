#pragma once
/// The pieces of one frame as triangles with all that a renderer asks of them.
#include <array>
#include <vector>

#include "output/detail/look.h"
#include "output/sequence.h"

namespace sunder::output::detail {

using Vec3f = Eigen::Vector3f;
using Rgb = Eigen::Array3f;  ///< linear

/// x -> (x - centre) * scale: from the world to coordinates in which what matters has the size of one.
struct Placement {
  Vec3 centre = Vec3::Zero();
  double scale = 1;

  Vec3 operator*(const Vec3& x) const { return (x - centre) * scale; }
};

/// Opaque triangles first. Lists by triangle have the length of `triangles`, `colour` may be empty (all white).
struct Soup {
  std::vector<Vec3f> vertices;
  std::vector<geometry::Triangle> triangles;
  std::size_t opaque = 0;                    ///< number of opaque triangles
  std::vector<std::array<Vec3f, 3>> normal;  ///< per corner, unit length
  std::vector<std::array<Rgb, 3>> colour;    ///< per corner, to be multiplied with that of the look
  std::vector<std::uint8_t> look;            ///< index into looks
  std::vector<int> surface;                  ///< 2 * piece, + 1 on cracks
  std::vector<Look> looks;
};

/// Of all pieces of the frame. Corners without a normal of their own get the mean of the normals around their vertex
/// that are within 40 degrees of their face's, by angle; faces on cracks their own.
Soup soup_of(const Sequence& sequence, const Frame& frame, const Placement& placement);

}  // namespace sunder::output::detail
