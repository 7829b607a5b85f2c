#pragma once
/// The vertices of a PLY file as damaged points: the mesh readers at hand drop properties that they do not know.
#include <filesystem>
#include <string_view>

#include "geometry/load_points.h"

namespace sunder::geometry::detail {

/// `bytes` are those of the file, which is named in errors only. Errors: ErrorKind::usage.
DamagedPoints parse_ply_points(const std::filesystem::path& file, std::string_view bytes);

}  // namespace sunder::geometry::detail
