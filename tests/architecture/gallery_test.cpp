/// The gallery's page, its pictures and the scenes belong together.
#include <filesystem>
#include <fstream>
#include <regex>
#include <set>
#include <sstream>
#include <string>

#include <gtest/gtest.h>

namespace {

namespace fs = std::filesystem;

const fs::path root = SUNDER_SOURCE_DIR;
constexpr std::uintmax_t largest_picture = 150'000;  // bytes: the repository stays small

std::set<std::string> found_in_page(const std::string& pattern) {
  std::stringstream text;
  text << std::ifstream(root / "docs/gallery.md").rdbuf();
  const std::string page = text.str();
  const std::regex expression(pattern);
  std::set<std::string> names;
  for (std::sregex_iterator match(page.begin(), page.end(), expression), end; match != end; ++match)
    names.insert((*match)[1]);
  return names;
}

TEST(Gallery, EveryPictureIsOfASceneSmallAndShown) {
  const std::set<std::string> shown = found_in_page(R"re(\(pictures/gallery/(\w+)\.png\))re");
  std::set<std::string> drawn;
  for (const auto& entry : fs::directory_iterator(root / "docs/pictures/gallery")) {
    drawn.insert(entry.path().stem());
    EXPECT_LE(entry.file_size(), largest_picture) << entry.path();
    EXPECT_TRUE(fs::exists(root / "assets/scenes" / (entry.path().stem().string() + ".toml"))) << entry.path();
  }
  EXPECT_FALSE(drawn.empty());
  EXPECT_EQ(shown, drawn);
}

TEST(Gallery, CommandsRunScenesThatExist) {
  const std::set<std::string> scenes = found_in_page(R"re(sunder run assets/scenes/(\w+)\.toml)re");
  EXPECT_EQ(scenes, found_in_page(R"re(\(pictures/gallery/(\w+)\.png\))re"));
  for (const std::string& scene : scenes) EXPECT_TRUE(fs::exists(root / "assets/scenes" / (scene + ".toml"))) << scene;
}

}  // namespace
