/// Effects that are off cost nothing: a run takes as many instructions as one of the program that is built without
/// them.
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <future>
#include <string>

#include <gtest/gtest.h>

#include "tests/output/scratch_folder.h"

namespace sunder::pipeline {
namespace {

namespace fs = std::filesystem;

constexpr double most_difference = 1e-3;

/// A hammer breaks a glass cube in two; whatever can be left out is.
constexpr const char* scene = R"([scene]
duration = 0.005
frame_rate = 240
quality = "draft"
[[body]]
name = "cube"
mesh = "box"
size = [0.04, 0.04, 0.04]
material = "glass"
[[body]]
name = "hammer"
mesh = "box"
size = [0.02, 0.02, 0.02]
position = [0.003, 0.042, 0.002]
velocity = [0, -24, 0]
material = "steel"
[effects]
secondary_fracture = "off"
flaws = "off"
two_velocity_fields = "off"
surface_detail = "off"
hairlines = "off"
debris = "off"
energy_ledger = "off"
[output]
page = false
poster = false
)";

/// Instructions that callgrind counts between the begin and the end of main while the program runs the scene. Loading,
/// which LD_BIND_NOW ends before that, depends on what symbols a program happens to have.
double instructions(const std::string& program, const fs::path& folder) {
  const fs::path binary = fs::read_symlink("/proc/self/exe").parent_path() / program;
  const fs::path counts = folder / (program + ".callgrind");
  fs::create_directory(folder);
  std::ofstream(folder / "cube.toml") << scene;
  const std::string command =
      "cd " + folder.string() +
      " && LD_BIND_NOW=1 valgrind -q --tool=callgrind --toggle-collect=main --callgrind-out-file=" + counts.string() +
      " " + binary.string() + " run cube.toml --no-prediction --threads 1 --log json --out out >run.log 2>&1";
  EXPECT_EQ(std::system(command.c_str()), 0) << output::read_all(folder / "run.log");
  EXPECT_NE(output::read_all(folder / "run.log").find("\"event\":\"fracture\""), std::string::npos);
  std::ifstream in(counts);
  for (std::string word; in >> word;)
    if (double count = 0; word == "totals:" && in >> count) return count;
  ADD_FAILURE() << "no count in " << counts;
  return 0;
}

TEST(EffectsCostSlow, WhatIsOffTakesNoInstructions) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "valgrind does not run sanitized programs";
#endif
  const output::ScratchFolder folder;
  auto counting = std::async(std::launch::async, instructions, "sunder_without_effects", folder / "without");
  const double with = instructions("sunder", folder / "with"), without = counting.get();
  std::printf("%.0f instructions, %.0f without effects, ratio %.6f\n", with, without, with / without);
  EXPECT_GT(without, 1e9);  // a solve took place
  EXPECT_LT(std::abs(with / without - 1), most_difference);
}

}  // namespace
}  // namespace sunder::pipeline
