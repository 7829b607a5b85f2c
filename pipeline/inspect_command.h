#pragma once
/// `sunder inspect MESH`: can it be broken, and if not, why.
#include <filesystem>

#include "geometry/load.h"

namespace sunder::pipeline {

struct InspectOptions {
  std::filesystem::path mesh;
  geometry::LoadSettings load;
  double height = 0;  ///< scaled to this height [m]; 0: as it is
  bool json = false;
};

/// Exit code for a mesh that is no solid and that repair makes one; ErrorKind::mesh is for those that it cannot mend.
constexpr int exit_mendable = 6;

/// Prints what the mesh is, what is wrong with it and what repair would do. Returns 0 for a solid, exit_mendable, or 3.
/// Errors: those of load_mesh.
int inspect_command(const InspectOptions& options);

}  // namespace sunder::pipeline
