/// A run whose disk fills up.
#include <cstdlib>
#include <filesystem>
#include <map>
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

/// A file system of its own, which takes a namespace in which the test may mount one.
constexpr const char* kMount = "unshare --user --map-root-user --mount sh -c 'mount -t tmpfs -o size=64k none ";

class FullDiskSlow : public testing::Test {
 protected:
  void SetUp() override {
    fs::create_directory(disk_);
    if (exit_code(kMount + disk_.string() + "' 2>/dev/null") != 0) GTEST_SKIP() << "no file systems of its own here";
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
  const int code = exit_code(kMount + disk_.string() + " && (" + run_command(disk_ / "out") + "); code=$?; cp -r " +
                             (disk_ / "out").string() + " " + kept.string() + "; exit $code'");
  EXPECT_EQ(code, 5);
  const std::string log = output::read_all(folder_ / "log");
  EXPECT_NE(log.find("No space left on device"), std::string::npos) << log;
  EXPECT_EQ(log.find("No space left"), log.rfind("No space left")) << "said once: " << log;
  EXPECT_TRUE(fs::exists(kept / "plate_ball.0001.obj"));
  for (const auto& entry : fs::directory_iterator(kept)) {
    const std::string name = entry.path().filename();
    EXPECT_FALSE(name.ends_with(".tmp")) << name;
    if (name.ends_with(".obj"))
      EXPECT_EQ(output::read_all(entry.path()), output::read_all(folder_ / "whole" / name)) << name;
  }
}

}  // namespace
}  // namespace sunder::pipeline
