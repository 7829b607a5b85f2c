/// How soon the report page answers: 1000 shards in 240 frames, opened in Debian's Chromium, which draws in software.
/// One table, and with --json FILE the same numbers by key; --keep FOLDER keeps the page.
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>

#include <nlohmann/json.hpp>
#include <unistd.h>

#include "core/error.h"
#include "tests/bench/table.h"
#include "tests/pipeline/burst.h"

namespace {

using namespace sunder;
namespace fs = std::filesystem;

// As many triangles as a bunny of 70 000 that is cut into 1000 Voronoi cells: 200 a shard.
constexpr pipeline::Burst burst = {.shards = 1000, .frames = 240, .subdivisions = 1, .frame_rate = 60};

nlohmann::json measured(const fs::path& folder) {
  const std::string command =
      "cd " SUNDER_NODE_TESTS " && SUNDER_PAGE=" + folder.string() + " node report_page.bench.mjs";
  if (std::system(command.c_str()) != 0) throw Error(ErrorKind::internal, "the browser did not finish");
  std::ifstream in(folder / "page_bench.json");
  return nlohmann::json::parse(in);
}

void measure(const fs::path& folder, const char* json) {
  pipeline::write_burst(burst, folder);
  const nlohmann::json result = measured(folder);
  bench::Table table;
  table.add("page_megabytes", static_cast<double>(fs::file_size(folder / "index.html")) / 1e6,
            "the page, geometry included");
  table.add("geometry_megabytes", static_cast<double>(fs::file_size(folder / "fragments.glb")) / 1e6, "fragments.glb");
  table.add("first_frame_seconds", result.at("first_frame"), "from opening to the first picture, median");
  table.add("interactive_seconds", result.at("interactive"), "from opening to the answer to a first scrub, median");
  table.add("scrub_seconds", result.at("scrub"), "from a later scrub to its picture, median");
  table.add("loader_seconds", result.at("loader"), "GLTFLoader of three.js and one frame of its mixer, median");
  table.add("decoder_seconds", result.at("decoder"), "what the page does instead, median");
  if (json) table.save(json);
}

}  // namespace

int main(int argc, char** argv) {
  const char* json = nullptr;
  const fs::path scratch = fs::temp_directory_path() / ("sunder_page_" + std::to_string(getpid()));
  fs::path folder = scratch;
  for (int i = 1; i < argc; i += 2) {
    const bool known = std::strcmp(argv[i], "--json") == 0 || std::strcmp(argv[i], "--keep") == 0;
    if (!known || i + 1 == argc) {
      std::fprintf(stderr, "usage: page_bench [--json FILE] [--keep FOLDER]\n");
      return 2;
    }
    if (std::strcmp(argv[i], "--json") == 0) json = argv[i + 1];
    if (std::strcmp(argv[i], "--keep") == 0) folder = fs::absolute(argv[i + 1]);
  }
  int code = 0;
  try {
    measure(folder, json);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "page_bench: %s\n", error.what());
    code = 1;
  }
  fs::remove_all(scratch);
  return code;
}
