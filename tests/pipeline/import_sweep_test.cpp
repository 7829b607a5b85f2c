/// Every test model of assimp and every mesh of CGAL gets a verdict, without a hang or a crash.
#include <cstdlib>
#include <map>
#include <sstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <sys/wait.h>
#include <tbb/parallel_for.h>

#include "output/atomic_file.h"
#include "pipeline/inspect_command.h"
#include "pipeline/scene.h"
#include "tests/output/scratch_folder.h"

namespace sunder::pipeline {
namespace {

namespace fs = std::filesystem;

// Ends what hangs. The goal is 10 s a file on an idle machine, which a test cannot hold a shared one to.
constexpr int kSeconds = 60;

/// What `sunder inspect` ends with, in a process of its own.
int exit_code(const fs::path& program, const fs::path& mesh, const fs::path& out) {
  std::ostringstream command;
  command << "timeout " << kSeconds << " " << program << " inspect --json " << mesh << " > " << out << " 2>&1";
  const int status = std::system(command.str().c_str());
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128;
}

std::vector<fs::path> files_below(const fs::path& folder) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    if (entry.is_regular_file()) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}

/// Runs the program on all of them; returns how often each code came.
std::map<int, int> sweep(const std::vector<fs::path>& files) {
  const output::ScratchFolder folder;
  const fs::path program = fs::read_symlink("/proc/self/exe").parent_path() / "sunder";
  std::vector<int> codes(files.size());
  tbb::parallel_for(std::size_t{0}, files.size(),
                    [&](std::size_t i) { codes[i] = exit_code(program, files[i], folder / std::to_string(i)); });
  std::map<int, int> counts;
  for (std::size_t i = 0; i < files.size(); ++i) {
    ++counts[codes[i]];
    const bool verdict = codes[i] == 0 || codes[i] == 3 || codes[i] == 5 || codes[i] == exit_mendable;
    EXPECT_TRUE(verdict) << files[i] << " ends with " << codes[i] << (codes[i] == 124 ? " (too slow)" : "");
    const std::string said = output::read_all(folder / std::to_string(i));
    EXPECT_FALSE(said.empty()) << files[i];
    const bool usable = codes[i] == 0 || codes[i] == exit_mendable;
    EXPECT_TRUE(!usable || nlohmann::json::accept(said)) << files[i];
  }
  for (const auto& [code, count] : counts) std::printf("exit code %d: %d files\n", code, count);
  return counts;
}

TEST(ImportSweepSlow, EveryModelOfAssimpGetsAVerdict) {
  const std::map<int, int> counts = sweep(files_below("/usr/share/assimp/models"));
  EXPECT_GT(counts.at(0) + counts.at(exit_mendable), 200) << "most models can be broken";
}

TEST(ImportSweepSlow, EveryMeshOfCgalGetsAVerdict) {
  const fs::path meshes = default_assets().mesh_cache;
  if (!fs::is_directory(meshes)) GTEST_SKIP() << "the demo meshes are not unpacked";
  const std::map<int, int> counts = sweep(files_below(meshes));
  EXPECT_GT(counts.at(0) + counts.at(exit_mendable), 100);
}

}  // namespace
}  // namespace sunder::pipeline
