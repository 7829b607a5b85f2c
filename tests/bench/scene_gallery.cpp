/// The pictures of docs/gallery.md: runs scenes and draws the telling frame of each as <folder>/<scene>.png, small and
/// finely sampled. Prints a row of the page's table for each: fragments at the end, quality, seconds.
///
///     scene_gallery FOLDER SCENE.toml... [--quality LEVEL]
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "core/progress.h"
#include "core/stopwatch.h"
#include "output/atomic_file.h"
#include "output/poster.h"
#include "pipeline/quality.h"
#include "pipeline/run.h"

namespace {

using namespace sunder;
namespace fs = std::filesystem;

constexpr std::size_t kLargestFile = 150'000;  // bytes

struct Arguments {
  fs::path folder;
  std::vector<fs::path> scenes;
  std::string quality;  ///< empty: that of the scene
};

[[noreturn]] void usage() {
  std::fputs("usage: scene_gallery FOLDER SCENE.toml... [--quality LEVEL]\n", stderr);
  std::exit(static_cast<int>(ErrorKind::usage));
}

Arguments read_arguments(int argc, char** argv) {
  Arguments arguments;
  for (int i = 1; i < argc; ++i) {
    if (std::strcmp(argv[i], "--quality") == 0) {
      if (++i == argc) usage();
      arguments.quality = argv[i];
    } else if (arguments.folder.empty()) {
      arguments.folder = argv[i];
    } else {
      arguments.scenes.emplace_back(argv[i]);
    }
  }
  if (arguments.scenes.empty()) usage();
  return arguments;
}

/// As wide as the file may be large.
std::string picture(const pipeline::Scene& scene, const output::Sequence& sequence) {
  const output::PosterScene place{scene.ground ? std::optional(scene.ground->height) : std::nullopt};
  output::PosterSettings settings;
  settings.samples = 16;
  for (settings.width = 640;; settings.width -= 64) {
    settings.height = settings.width * 9 / 16;
    const std::string png = output::poster_png(sequence, output::telling_frame(sequence), place, settings);
    if (png.size() <= kLargestFile) return png;
  }
}

/// "12", "12 (left 5, right 7)".
std::string fragments(const output::Sequence& sequence) {
  constexpr std::size_t kNamed = 4;  // bodies at most
  std::map<std::string, int> of_body;
  int all = 0;
  for (const output::PiecePose& pose : sequence.frames.back().poses) {
    const output::Piece& piece = sequence.pieces[static_cast<std::size_t>(pose.piece)];
    if (piece.parent < 0) continue;
    ++of_body[piece.body];
    ++all;
  }
  std::string names;
  for (const auto& [name, count] : of_body) names += (names.empty() ? "" : ", ") + name + " " + std::to_string(count);
  const bool named = of_body.size() > 1 && of_body.size() <= kNamed;
  return std::to_string(all) + (named ? " (" + names + ")" : "");
}

void draw(const Arguments& arguments, const fs::path& file) {
  pipeline::Scene scene = pipeline::load_scene(file);
  if (!arguments.quality.empty()) {
    const auto quality = pipeline::quality_of(arguments.quality);
    if (!quality) usage();
    scene.quality = *quality;
  }
  pipeline::Outputs& outputs = scene.outputs;
  outputs.obj = outputs.glb = outputs.page = outputs.blender = outputs.poster = false;
  outputs.checkpoint_interval = 0;
  const fs::path scratch = fs::temp_directory_path() / ("scene_gallery_" + scene.name);
  SilentProgress progress;
  const pipeline::RunResult result = pipeline::run(scene, {.out = scratch}, progress);
  fs::remove_all(scratch);
  double seconds = 0;
  std::string png;
  {
    const Stopwatch watch(seconds);
    png = picture(scene, result.sequence);
  }
  output::write_atomically(arguments.folder / (scene.name + ".png"), png);
  std::printf("| `%s` | %s | %s | %.0f | %.1f |\n", scene.name.c_str(), pipeline::name_of(scene.quality).c_str(),
              fragments(result.sequence).c_str(), result.report.seconds.total, seconds);
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) try {
  const Arguments arguments = read_arguments(argc, argv);
  output::create_folder(arguments.folder);
  for (const fs::path& scene : arguments.scenes) draw(arguments, scene);
} catch (const Error& error) {
  std::fprintf(stderr, "scene_gallery: %s\n", error.what());
  return static_cast<int>(error.kind());
}
