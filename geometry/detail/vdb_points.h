#pragma once
/// Damaged points out of OpenVDB files.
#include <filesystem>

#include "geometry/load_points.h"

namespace sunder::geometry::detail {

/// See load_points. Errors: ErrorKind::io when OpenVDB cannot read the file, ErrorKind::usage when no grid fits.
DamagedPoints load_vdb_points(const std::filesystem::path& file);

}  // namespace sunder::geometry::detail
