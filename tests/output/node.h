#pragma once
/// Programs of tests/node, run on files that a test wrote.
#include <cstdlib>
#include <filesystem>
#include <sstream>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/output/scratch_folder.h"

namespace sunder::output {

/// What the script prints, as JSON. Fails the test when it does not end well.
inline nlohmann::json run_node(const std::string& script, const std::vector<std::filesystem::path>& files) {
  const std::filesystem::path out = files.front().parent_path() / (script + ".out");
  std::ostringstream command;
  command << "node " << std::filesystem::path(SUNDER_NODE_TESTS) / script;
  for (const auto& file : files) command << " " << file;
  command << " > " << out << " 2> " << out.string() + ".err";
  EXPECT_EQ(std::system(command.str().c_str()), 0) << read_all(out.string() + ".err");
  return nlohmann::json::parse(read_all(out), nullptr, false);
}

}  // namespace sunder::output
