#pragma once
/// The report page as page/build.mjs bundles it: HTML, style and script, cut where the data of a run go.
#include <array>
#include <string_view>

namespace sunder::pipeline::detail {

/// Between its parts stand, in this order: the report, the scene, the size of the geometry in bytes, the geometry.
extern const std::array<std::string_view, 5> page_template;

}  // namespace sunder::pipeline::detail
