/// The include graph points down only, and no third-party type leaves a module.
#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace {

namespace fs = std::filesystem;

const fs::path root = SUNDER_SOURCE_DIR;

const std::map<std::string, std::set<std::string>> allowed = {
    {"core", {"core"}},
    {"statistics", {"core", "statistics"}},
    {"geometry", {"core", "geometry"}},
    {"mpm", {"core", "geometry", "mpm"}},
    {"crack", {"core", "geometry", "crack"}},
    {"rigid", {"core", "geometry", "rigid", "tbb"}},
    {"output", {"core", "geometry", "output"}},
    {"validation", {"core", "geometry", "mpm", "crack", "rigid", "statistics", "validation"}},
    {"pipeline", {"core", "geometry", "mpm", "crack", "rigid", "output", "validation", "statistics", "pipeline"}},
    {"batch", {"core", "geometry", "crack", "output", "pipeline", "batch"}},
    {"cli", {"core", "geometry", "crack", "output", "pipeline", "batch", "cli"}},
};

/// Which third-party header prefixes a module's .cpp files and detail headers may include.
const std::map<std::string, std::set<std::string>> libraries = {
    {"core", {}},
    {"statistics", {}},
    {"geometry", {"CGAL", "openvdb", "assimp", "boost", "tbb"}},
    {"mpm", {"tbb"}},
    {"crack", {"voro++", "tbb"}},
    {"rigid",
     {"btBulletDynamicsCommon.h", "btBulletCollisionCommon.h", "BulletCollision", "BulletDynamics", "LinearMath",
      "tbb"}},
    {"output", {"tiny_gltf.h", "embree3", "png.h", "zip.h", "openssl", "tbb"}},
    {"validation", {"tbb"}},
    {"pipeline", {"cereal", "toml++", "nlohmann", "tbb"}},
    {"batch", {"sqlite3.h", "toml++", "nlohmann", "tbb"}},
    {"cli", {"CLI", "nlohmann"}},
};

struct Include {
  std::string target;
  bool quoted;
};

std::vector<Include> includes_of(const fs::path& file) {
  std::vector<Include> result;
  std::ifstream in(file);
  const std::regex pattern(R"re(^\s*#\s*include\s*([<"])([^>"]+)[>"])re");
  for (std::string line; std::getline(in, line);) {
    std::smatch match;
    if (std::regex_search(line, match, pattern)) result.push_back({match[2], match[1] == "\""});
  }
  return result;
}

std::vector<fs::path> sources(const std::string& module) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::recursive_directory_iterator(root / module))
    if (entry.path().extension() == ".h" || entry.path().extension() == ".cpp") files.push_back(entry.path());
  return files;
}

std::string first_component(const std::string& path) { return path.substr(0, path.find('/')); }

bool is_standard(const std::string& header) {
  return header.find('/') == std::string::npos && header.find('.') == std::string::npos;
}

bool is_system(const std::string& header) {
  static const std::set<std::string> files = {"unistd.h", "immintrin.h", "fcntl.h", "poll.h", "glob.h"};
  return files.contains(header) || first_component(header) == "sys";
}

TEST(IncludeGraph, PointsDownOnly) {
  for (const auto& [module, below] : allowed)
    for (const fs::path& file : sources(module))
      for (const Include& include : includes_of(file))
        if (include.quoted && include.target != "sunder_version.h") {
          EXPECT_TRUE(below.contains(first_component(include.target))) << file << " includes " << include.target;
        }
}

TEST(IncludeGraph, PublicHeadersShowEigenAndTheStandardLibraryOnly) {
  for (const auto& [module, below] : allowed)
    for (const fs::path& file : sources(module)) {
      if (file.extension() != ".h" || file.parent_path().filename() == "detail") continue;
      for (const Include& include : includes_of(file)) {
        if (include.quoted) {
          EXPECT_EQ(include.target.find("/detail/"), std::string::npos) << file << " includes " << include.target;
        } else {
          EXPECT_TRUE(is_standard(include.target) || first_component(include.target) == "Eigen")
              << file << " includes <" << include.target << ">";
        }
      }
    }
}

TEST(IncludeGraph, LibrariesStayBehindTheirModule) {
  for (const auto& [module, below] : allowed)
    for (const fs::path& file : sources(module))
      for (const Include& include : includes_of(file)) {
        if (include.quoted || is_standard(include.target) || is_system(include.target)) continue;
        const std::string library = first_component(include.target);
        EXPECT_TRUE(library == "Eigen" || libraries.at(module).contains(library))
            << file << " includes <" << include.target << ">";
      }
}

TEST(IncludeGraph, EveryModuleIsScanned) {
  for (const auto& [module, below] : allowed) EXPECT_FALSE(sources(module).empty()) << module;
}

}  // namespace
