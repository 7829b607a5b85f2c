/// A run whose disk fills up.
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <string>

#include <gtest/gtest.h>
#include <sys/wait.h>

#include "tests/output/scratch_folder.h"

namespace sunder::pipeline {
namespace {

namespace fs = std::filesystem;
using output::ScratchFolder;

int exit_code(const std::string& command) {
  const int status = std::system(command.c_str());
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

/// Runs the command where a disk of so many bytes is mounted on the folder: a file system of its own takes a namespace.
int exit_code_on_disk(std::uintmax_t bytes, const fs::path& disk, const std::string& command) {
  return exit_code("unshare --user --map-root-user --mount sh -c 'mount -t tmpfs -o size=" + std::to_string(bytes) +
                   " none " + disk.string() + " && " + command + "'");
}

class FullDiskSlow : public testing::Test {
 protected:
  void SetUp() override {
    fs::create_directory(disk_);
    if (exit_code_on_disk(65536, disk_, "true") != 0) GTEST_SKIP() << "no file systems of its own here";
  }

  std::string run_command(const fs::path& out) const {
    const fs::path binary = fs::read_symlink("/proc/self/exe").parent_path() / "sunder";
    return binary.string() + " run " + (fs::path(SUNDER_SOURCE_DIR) / "assets/scenes/plate_ball.toml").string() +
           " --quality draft --frames 1-4 --out " + out.string() + " >" + (folder_ / "log").string() + " 2>&1";
  }

  ScratchFolder folder_;
  const fs::path disk_ = folder_ / "disk";
};

/// The whole plate fits, its fragments do not.
TEST_F(FullDiskSlow, KeepsTheFramesBeforeAndSaysWhatIsMissing) {
  ASSERT_EQ(exit_code(run_command(folder_ / "whole")), 0);
  const fs::path kept = folder_ / "kept";
  const std::uintmax_t first = fs::file_size(folder_ / "whole/plate_ball.0001.obj"),
                       second = fs::file_size(folder_ / "whole/plate_ball.0002.obj");
  ASSERT_GT(second, 4 * first);
  const int code = exit_code_on_disk(first + second / 2, disk_,
                                     "{ " + run_command(disk_ / "out") + "; code=$?; cp -r " +
                                         (disk_ / "out").string() + " " + kept.string() + "; exit $code; }");
  EXPECT_EQ(code, 5);
  const std::string log = output::read_all(folder_ / "log");
  EXPECT_EQ(log.find("No space left"), log.rfind("No space left")) << "said once: " << log;
  EXPECT_NE(log.find("plate_ball.0002.obj: No space"), std::string::npos) << log;
  EXPECT_TRUE(fs::exists(kept / "plate_ball.0001.obj"));
  for (const auto& entry : fs::directory_iterator(kept)) {
    const std::string name = entry.path().filename();
    EXPECT_FALSE(name.ends_with(".tmp")) << name;
    if (!name.ends_with(".obj")) continue;
    EXPECT_EQ(output::read_all(entry.path()), output::read_all(folder_ / "whole" / name)) << name;
  }
}

}  // namespace
}  // namespace sunder::pipeline
