#pragma once
/// The program with a plan, as a user starts it.
#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <map>
#include <string>

#include <sys/wait.h>

#include "geometry/load.h"
#include "geometry/primitives.h"
#include "tests/output/scratch_folder.h"

namespace sunder::batch {

struct Ended {
  int code = -1;
  std::string said;  ///< on stdout and stderr
};

inline Ended ended(const std::string& command) {
  FILE* pipe = popen(("{ " + command + "; } 2>&1").c_str(), "r");
  Ended end;
  std::array<char, 4096> piece;
  while (const std::size_t count = std::fread(piece.data(), 1, piece.size(), pipe))
    end.said.append(piece.data(), count);
  const int status = pclose(pipe);
  end.code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  return end;
}

inline std::string program() {
  return (std::filesystem::read_symlink("/proc/self/exe").parent_path() / "sunder").string();
}

/// What the plan's jobs left, by file, but for what differs from one time to the next.
inline std::map<std::string, std::string> lasting_files(const std::filesystem::path& out) {
  std::map<std::string, std::string> files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(out / "jobs")) {
    const std::string name = entry.path().filename();
    if (!entry.is_regular_file() || name == "measured.json" || name == "log.txt") continue;
    files[entry.path().lexically_relative(out).string()] = output::read_all(entry.path());
  }
  return files;
}

}  // namespace sunder::batch
