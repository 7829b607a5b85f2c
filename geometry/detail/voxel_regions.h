#pragma once
/// Which region the points of a grid lie in.
#include <array>
#include <vector>

#include "geometry/detail/crack_complex.h"

namespace sunder::geometry::detail {

/// Points origin + spacing * (i, j, k).
struct Lattice {
  Vec3 origin;
  double spacing;
  std::array<int, 3> count;

  int size() const { return count[0] * count[1] * count[2]; }
  int index(int i, int j, int k) const { return i + count[0] * (j + count[1] * k); }
  Vec3 point(int index) const {
    return origin + spacing * Vec3(index % count[0], index / count[0] % count[1], index / count[0] / count[1]);
  }
};

/// Per point of the lattice its region, -1 where `wanted` is false. Regions spread from point to point within what is
/// wanted and change where crack faces cross the line between two points; every connected part asks for the region of
/// its first point.
std::vector<int> voxel_regions(const Lattice& lattice, const std::vector<char>& wanted, const CrackComplex& complex);

}  // namespace sunder::geometry::detail
