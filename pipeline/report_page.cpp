#include "pipeline/report_page.h"

#include <fstream>
#include <sstream>

#include <nlohmann/json.hpp>

#include "core/error.h"
#include "output/atomic_file.h"
#include "pipeline/detail/page_template.h"

namespace sunder::pipeline {
namespace {

namespace fs = std::filesystem;

constexpr const char* kept_scene = "scene.toml";

void replace_all(std::string& text, std::string_view what, std::string_view by) {
  for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + by.size()))
    text.replace(at, what.size(), by);
}

/// In JSON these stand in strings only, where the escapes mean the same. U+2028 ends a line of JavaScript.
std::string escaped_json(std::string_view json) {
  std::string text(json);
  replace_all(text, "<", "\\u003c");
  replace_all(text, "\u2028", "\\u2028");
  return text;
}

/// Undone by the page (page/src/data.js): a script element takes no entities.
std::string escaped_text(std::string_view plain) {
  std::string text(plain);
  replace_all(text, "&", "&amp;");
  replace_all(text, "<", "&lt;");
  return text;
}

std::string base64(std::string_view bytes) {
  constexpr std::string_view digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t count = std::min<std::size_t>(3, bytes.size() - i);
    unsigned triple = 0;
    for (std::size_t k = 0; k < 3; ++k)
      triple = triple << 8 | (k < count ? static_cast<unsigned char>(bytes[i + k]) : 0u);
    for (std::size_t k = 0; k < 4; ++k) text += k <= count ? digits[triple >> (18 - 6 * k) & 63] : '=';
  }
  return text;
}

std::string read_file(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::ostringstream bytes;
  bytes << in.rdbuf();
  if (!in) throw Error(ErrorKind::io, "cannot read " + file.string());
  return std::move(bytes).str();
}

std::string read_if_there(const fs::path& file) { return fs::exists(file) ? read_file(file) : std::string(); }

std::string read_report(const fs::path& file) {
  if (!fs::exists(file))
    throw Error(ErrorKind::io, "there is no " + file.string() + "; a page is made of what a run left in its folder");
  std::string text = read_file(file);
  const auto json = nlohmann::json::parse(text, nullptr, false);
  if (!json.is_object() || !json.contains("fragments"))
    throw Error(ErrorKind::io, file.string() + " is not the report of a run");
  return text;
}

}  // namespace

std::string report_page(std::string_view report_json, std::string_view scene_text, std::string_view glb_bytes) {
  const std::string geometry = glb_bytes.size() <= largest_page_geometry ? base64(glb_bytes) : std::string();
  const std::array<std::string, 4> data = {escaped_json(report_json), escaped_text(scene_text),
                                           std::to_string(glb_bytes.size()), geometry};
  std::string page(detail::page_template[0]);
  for (std::size_t i = 0; i < data.size(); ++i) page.append(data[i]).append(detail::page_template[i + 1]);
  return page;
}

void keep_scene(const fs::path& scene_file, const fs::path& folder) {
  output::write_atomically(folder / kept_scene, read_file(scene_file));
}

void write_report_page(const fs::path& folder) {
  const std::string report = read_report(folder / "report.json");
  output::write_atomically(folder / "index.html", report_page(report, read_if_there(folder / kept_scene),
                                                              read_if_there(folder / "fragments.glb")));
}

}  // namespace sunder::pipeline
