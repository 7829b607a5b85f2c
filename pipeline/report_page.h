#pragma once
/// index.html: the report of a run as one page that opens from disk with no network. Its sources are in page/;
/// docs/outputs.md says what it shows.
#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>

namespace sunder::pipeline {

/// Larger geometry is left out of the page, which then says how to view fragments.glb: browsers hold the page, its
/// text and what is decoded from it in memory at once [bytes].
constexpr std::size_t largest_page_geometry = 200'000'000;

/// The page of a run. `report_json`: what report.json holds; `scene_text`: the scene file, empty: none was kept;
/// `glb_bytes`: what fragments.glb holds, empty: the run wrote none. All are escaped so that nothing in them ends the
/// element that carries them.
std::string report_page(std::string_view report_json, std::string_view scene_text, std::string_view glb_bytes);

/// Copies the scene file to scene.toml in the folder of its results. Errors: ErrorKind::io.
void keep_scene(const std::filesystem::path& scene_file, const std::filesystem::path& folder);

/// Writes index.html from what a run left in the folder: report.json, and scene.toml and fragments.glb if they are
/// there. Errors: ErrorKind::io when report.json is missing or no report, or a file cannot be read or written.
void write_report_page(const std::filesystem::path& folder);

}  // namespace sunder::pipeline
