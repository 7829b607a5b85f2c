#pragma once
/// A mesh with its attributes as bytes, for another process of the same program.
#include <string>
#include <string_view>

#include "geometry/load.h"

namespace sunder::geometry::detail {

std::string packed(const TexturedMesh& mesh);

/// `bytes` are of `packed`; asserted.
TexturedMesh unpacked(std::string_view bytes);

}  // namespace sunder::geometry::detail
