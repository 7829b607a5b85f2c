#pragma once
/// A surface of several shells as solids: each outer shell with the voids in it.
#include <vector>

#include "geometry/mesh.h"

namespace sunder::geometry::detail {

struct Shell {
  TriangleMesh mesh;
  std::vector<int> source;  // per face
  double volume = 0;        // signed: a void is negative
};

/// Gives every void to the smallest outer shell around it and appends its faces there; shells must not cross.
/// Outer shells keep their order. Errors: ErrorKind::mesh when a void has no shell around it or a shell has no volume.
std::vector<Shell> nest(std::vector<Shell> shells);

}  // namespace sunder::geometry::detail
