#include "pipeline/report.h"

#include <fstream>
#include <iterator>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace sunder::pipeline {
namespace {

output::Sequence broken_cup() {
  output::Sequence sequence;
  sequence.name = "cup";
  output::Piece cup, shard;
  cup.name = cup.body = "cup";
  cup.death_time = 0.1;
  shard.id = 1;
  shard.name = "cup_0001";
  shard.body = "cup";
  shard.parent = 0;
  shard.generation = 1;
  shard.birth_time = 0.1;
  shard.volume = 2e-6;
  shard.mass = 5e-3;
  shard.closed = true;
  sequence.pieces = {cup, shard};
  sequence.frames.resize(3);
  return sequence;
}

TEST(Report, ListsLivingFragmentsOnly) {
  const auto json = nlohmann::json::parse(to_json(Report{}, broken_cup()));
  EXPECT_EQ(json["fragments"]["count"], 1);
  EXPECT_EQ(json["fragments"]["closed"], 1);
  EXPECT_EQ(json["fragments"]["list"][0]["name"], "cup_0001");
  EXPECT_EQ(json["fragments"]["list"][0]["parent"], 0);
  EXPECT_DOUBLE_EQ(json["fragments"]["list"][0]["mass"], 5e-3);
  EXPECT_EQ(json["frames"]["count"], 3);
}

TEST(Report, VolumeErrorIsTheWorstOfAllFractures) {
  Report report;
  report.fractures.resize(3);
  report.fractures[1].volume_error = 3e-9;
  EXPECT_DOUBLE_EQ(nlohmann::json::parse(to_json(report, broken_cup()))["fragments"]["volume_error"], 3e-9);
}

TEST(Report, SpeedIsParticleStepsOverSolveSeconds) {
  Report report;
  report.particle_steps = 3000;
  report.fractures.resize(2);
  report.fractures[0].seconds.solve = 0.5;
  report.fractures[1].seconds.solve = 1.0;
  EXPECT_DOUBLE_EQ(nlohmann::json::parse(to_json(report, broken_cup()))["mpm"]["particle_steps_per_second"], 2000);
}

TEST(Report, EveryKeyIsDocumented) {
  std::ifstream in(std::string(SUNDER_SOURCE_DIR) + "/docs/report.md");
  const std::string text{std::istreambuf_iterator<char>(in), {}};
  Report report;
  report.fractures.resize(1);
  report.fractures[0].energy.emplace();
  report.effects = effect_records({}, {});
  report.repairs.push_back({"cup", {{"filled 1 hole"}, false, 1, 1.5, 0.01}});
  const auto json = nlohmann::json::parse(to_json(report, broken_cup()));
  for (const auto& [key, value] : json.items()) EXPECT_NE(text.find(key), std::string::npos) << key;
  for (const auto& [key, value] : json["fractures"][0].items()) EXPECT_NE(text.find(key), std::string::npos) << key;
  for (const auto& [key, value] : json["fractures"][0]["energy"].items())
    EXPECT_NE(text.find(key), std::string::npos) << key;
  for (const auto& effect : json["effects"]) {
    for (const auto& [key, value] : effect.items()) EXPECT_NE(text.find(key), std::string::npos) << key;
    for (const auto& [key, value] : effect["work"].items()) EXPECT_NE(text.find(key), std::string::npos) << key;
  }
  for (const auto& [key, value] : json["fragments"]["list"][0].items())
    EXPECT_NE(text.find(key), std::string::npos) << key;
  for (const auto& [key, value] : json["seconds"].items()) EXPECT_NE(text.find(key), std::string::npos) << key;
}

/// Names are counted where they happen, as fallbacks["name"] or count("name") in these files.
TEST(Report, EveryFallbackIsDocumented) {
  std::ifstream doc(std::string(SUNDER_SOURCE_DIR) + "/docs/report.md");
  const std::string text{std::istreambuf_iterator<char>(doc), {}};
  int found = 0;
  for (const char* file :
       {"/pipeline/cracking.cpp", "/pipeline/fracture.cpp", "/pipeline/simulation.cpp", "/pipeline/breaking.cpp"}) {
    std::ifstream in(SUNDER_SOURCE_DIR + std::string(file));
    const std::string code{std::istreambuf_iterator<char>(in), {}};
    for (const std::string mark : {"fallbacks[\"", "count(\""})
      for (std::size_t at = code.find(mark); at != std::string::npos; at = code.find(mark, at + 1)) {
        const std::size_t begin = at + mark.size();
        const std::string name = code.substr(begin, code.find('"', begin) - begin);
        EXPECT_NE(text.find("`" + name + "`"), std::string::npos) << name;
        ++found;
      }
  }
  EXPECT_GE(found, 12);
}

}  // namespace
}  // namespace sunder::pipeline
