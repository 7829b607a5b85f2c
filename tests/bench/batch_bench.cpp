/// Batches: draft fractures in a core-hour and where their time goes, what the batch itself costs, and what collecting
/// many results takes.
///     batch_bench [--json FILE] [--jobs N] [--results N]
#include <cstdio>
#include <fstream>
#include <map>
#include <string>

#include <nlohmann/json.hpp>
#include <unistd.h>

#include "batch/plan.h"
#include "core/resources.h"
#include "core/stopwatch.h"
#include "tests/batch/fabricated.h"
#include "tests/bench/table.h"

namespace {

using namespace sunder;
using namespace sunder::batch;
namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

fs::path scratch() { return fs::temp_directory_path() / ("sunder_batch_bench_" + std::to_string(getpid())); }

fs::path written_plan(const std::string& name, const std::string& text) {
  fs::create_directories(scratch());
  std::ofstream(scratch() / name) << text;
  return scratch() / name;
}

/// The armadillo has 52 000 faces.
void measure_fractures(int jobs, bench::Table& table) {
  const fs::path plan = written_plan(
      "fractures.toml",
      "[plan]\nsamples = " + std::to_string(jobs) +
          "\nkeep = [\"dataset\", \"still\"]\n[job]\nmesh = \"armadillo\"\nheight = 0.2\nmaterial = "
          "\"glass\"\nquality = \"draft\"\nimpact = \"random\"\nseverity = { log_uniform = [20, 2000] }\n");
  const fs::path out = scratch() / "fractures";
  const std::string program = (fs::read_symlink("/proc/self/exe").parent_path() / "sunder").string();
  const double start = cpu_seconds();
  double wall = 0;
  {
    const Stopwatch watch(wall);
    const std::string command = program + " batch " + plan.string() + " --progress off --out " + out.string();
    if (std::system(command.c_str()) != 0) std::printf("some jobs failed\n");
  }
  const double processor = cpu_seconds() - start;
  double of_jobs = 0;
  std::map<std::string, double> stages;
  std::ifstream lines(out / "manifest.jsonl");
  for (std::string line; std::getline(lines, line);) {
    const Json measured = Json::parse(line).at("measured");
    of_jobs += measured.at("processor_seconds").get<double>();
    for (const auto& [stage, seconds] : measured.at("stages").items()) stages[stage] += seconds.get<double>();
  }
  table.add("fractures_per_core_hour", 3600 * jobs / processor,
            "draft, 52000 faces, with data set and still (goal 3000)");
  table.add("seconds_of_wall_clock", wall, std::to_string(jobs) + " of them");
  table.add("batch_share", (processor - of_jobs) / processor, "of the processor time: the batch itself (goal 0.02)");
  double sum = 0;
  for (const auto& [stage, seconds] : stages) sum += seconds;
  for (const auto& [stage, seconds] : stages) table.add("share_" + stage, seconds / sum, "of the jobs' time");
}

void measure_collecting(int count, bench::Table& table) {
  std::ofstream(written_plan("block.obj", ""));
  const fs::path out = scratch() / "many";
  const Plan plan =
      load_plan(written_plan("many.toml", "[plan]\nsamples = " + std::to_string(count) +
                                              "\n[job]\nmesh = \"block.obj\"\ncells = { integer = [2, 99] }\n"));
  fabricate(plan, out);
  const Collecting measured = measured_collecting(plan, out);
  table.add("collect_seconds_per_million", measured.seconds * 1e6 / count,
            "from " + std::to_string(count) + " results");
  table.add("collect_memory_mb", measured.memory_mb, "most while collecting (goal 500)");
  table.add("manifest_bytes_per_job", static_cast<double>(fs::file_size(out / "manifest.sqlite")) / count, "SQLite");
}

}  // namespace

int main(int argc, char** argv) {
  std::string json;
  int jobs = 60, results = 20000;
  for (int i = 1; i + 1 < argc; i += 2) {
    const std::string option = argv[i];
    if (option == "--json") json = argv[i + 1];
    if (option == "--jobs") jobs = std::stoi(argv[i + 1]);
    if (option == "--results") results = std::stoi(argv[i + 1]);
  }
  bench::Table table;
  if (jobs > 0) measure_fractures(jobs, table);
  if (results > 0) measure_collecting(results, table);
  fs::remove_all(scratch());
  if (!json.empty()) table.save(json.c_str());
}
