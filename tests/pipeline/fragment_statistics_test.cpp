/// Statistics of small sequences by hand, and their keys.
#include "pipeline/fragment_statistics.h"

#include <fstream>
#include <iterator>
#include <set>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "geometry/primitives.h"
#include "statistics/laws.h"

namespace sunder::pipeline {
namespace {

output::Piece piece(int id, const std::string& body, int parent, double volume, double birth) {
  output::Piece p;
  p.id = id;
  p.body = body;
  p.name = parent < 0 ? body : output::fragment_name(body, id);
  p.parent = parent;
  p.volume = volume;
  p.birth_time = birth;
  return p;
}

/// A cup (8) and a plate (5): the cup breaks into 5 + 2 + 1 at 0.1 s, its largest fragment into 3 + 1.5 at 0.3 s (0.5
/// is lost), the plate into 4 + 1 at 0.1 s. A ball stays whole.
output::Sequence broken_twice() {
  output::Sequence sequence;
  sequence.pieces = {piece(0, "cup", -1, 8, 0),    piece(1, "plate", -1, 5, 0),  piece(2, "ball", -1, 100, 0),
                     piece(3, "cup", 0, 5, 0.1),   piece(4, "cup", 0, 2, 0.1),   piece(5, "cup", 0, 1, 0.1),
                     piece(6, "plate", 1, 4, 0.1), piece(7, "plate", 1, 1, 0.1), piece(8, "cup", 3, 3, 0.3),
                     piece(9, "cup", 3, 1.5, 0.3)};
  sequence.pieces[0].death_time = sequence.pieces[1].death_time = 0.1;
  sequence.pieces[3].death_time = 0.3;
  return sequence;
}

/// One body in `count` fragments with the volumes of a law.
output::Sequence shattered(statistics::Law law, std::size_t count) {
  output::Sequence sequence;
  sequence.pieces = {piece(0, "cup", -1, 1, 0)};
  sequence.pieces[0].death_time = 0.1;
  for (const double z : statistics::standard_sample(law, count, 4, 4))
    sequence.pieces.push_back(piece(static_cast<int>(sequence.pieces.size()), "cup", 0, std::exp(2 * z - 14), 0.1));
  return sequence;
}

TEST(FragmentStatistics, CountOnlyWhatExistsAtTheEnd) {
  const FragmentStatistics s = fragment_statistics({}, broken_twice());
  EXPECT_EQ(s.fragments, 6u);  // 2, 1, 4, 1, 3, 1.5
  EXPECT_DOUBLE_EQ(*s.largest_share, 4 / 12.5);
  EXPECT_EQ(s.volume->minimum, 1);
  EXPECT_EQ(s.volume->median, 1.75);
  EXPECT_DOUBLE_EQ(s.volume->mean, 12.5 / 6);
  EXPECT_EQ(s.volume->maximum, 4);
}

TEST(FragmentStatistics, ClosureIsOfBodiesThatBroke) {
  const FragmentStatistics s = fragment_statistics({}, broken_twice());
  ASSERT_EQ(s.closure.size(), 2u);
  EXPECT_EQ(s.closure[0].body, "cup");
  EXPECT_EQ(s.closure[0].fragments, 7.5);
  EXPECT_EQ(s.closure[0].relative_error, -0.5 / 8);
  EXPECT_EQ(s.closure[1].body, "plate");
  EXPECT_EQ(s.closure[1].relative_error, 0);
}

TEST(FragmentStatistics, CountsFollowTime) {
  const FragmentStatistics s = fragment_statistics({}, broken_twice());
  ASSERT_EQ(s.counts.size(), 3u);
  const auto is = [](const FragmentCount& c, double time, const std::string& body, int born, int alive) {
    return c.time == time && c.body == body && c.born == born && c.alive == alive;
  };
  EXPECT_TRUE(is(s.counts[0], 0.1, "cup", 3, 3));
  EXPECT_TRUE(is(s.counts[1], 0.1, "plate", 2, 2));
  EXPECT_TRUE(is(s.counts[2], 0.3, "cup", 2, 4));
}

TEST(FragmentStatistics, SizesOfEachFractureAreNamedByWhatBroke) {
  Report report;
  report.fractures.resize(2);
  report.fractures[0].piece = 3;  // stayed whole at first
  report.fractures[0].time = 0.2;
  report.fractures[1].piece = 3;
  report.fractures[1].time = 0.29;
  report.fractures[1].fragments = 2;
  const FragmentStatistics s = fragment_statistics(report, broken_twice());
  ASSERT_EQ(s.per_fracture.size(), 3u);
  EXPECT_EQ(s.per_fracture[0].piece, "cup");
  EXPECT_EQ(s.per_fracture[0].time, 0.1);
  EXPECT_EQ(s.per_fracture[0].median_volume, 2);
  EXPECT_EQ(s.per_fracture[0].largest_share, 5.0 / 8);
  EXPECT_EQ(s.per_fracture[2].piece, "cup_0003");
  EXPECT_EQ(s.per_fracture[2].time, 0.29);
  EXPECT_EQ(s.per_fracture[2].fragments, 2);
  EXPECT_EQ(s.per_fracture[2].median_volume, 2.25);
}

TEST(FragmentStatistics, EnergyIsThatOfBirthsFracturesAndTheLastFrame) {
  output::Sequence sequence = broken_twice();
  sequence.pieces[0].birth_energy = 3;
  sequence.pieces[2].birth_energy = 4;
  sequence.pieces[4].birth_energy = 99;  // a fragment's: no start
  output::Piece& rod = sequence.pieces[4];
  rod.mesh = geometry::box({1, 2, 1});
  rod.mass = 24;
  const double s = std::sqrt(0.5);
  // Turned by 90 degrees about Z, so its long side is X; spin about Z and X.
  const Pose turned{Vec3(7, 7, 7), Quat(s, 0, 0, s)};
  sequence.frames.resize(1);
  sequence.frames[0].poses = {{4, turned, {Vec3(0, 2, 0), Vec3(3, 0, 1)}}};
  Report report;
  report.fractures.resize(2);
  report.fractures[0].kinetic_before = 10;
  report.fractures[0].kinetic_after = 6;
  report.fractures[0].crack_energy = 1.5;
  report.fractures[1].crack_energy = 0.25;
  const EnergyBalance energy = fragment_statistics(report, sequence).energy;
  EXPECT_EQ(energy.kinetic_start, 7);
  EXPECT_EQ(energy.fracture, 1.75);
  EXPECT_EQ(energy.lost_in_fractures, 4);
  // m v^2 / 2 = 48; I_x = m (1 + 1) / 12 = 4, I_z = m (1 + 4) / 12 = 10.
  EXPECT_NEAR(*energy.kinetic_end, 48 + 4 * 9 / 2.0 + 10 / 2.0, 1e-12);
}

TEST(FragmentStatistics, FitsAreOfAllVolumes) {
  const FragmentStatistics s = fragment_statistics({}, shattered(statistics::Law::log_normal, 60));
  ASSERT_EQ(s.fits.size(), 6u);
  for (const statistics::Fit& fit : s.fits) EXPECT_TRUE(fit.above || fit.count == 60) << fit.law;
  EXPECT_EQ(s.fits_note, "");
}

TEST(FragmentStatistics, NoteSaysWhatLimitsTheFits) {
  const auto note = [](const output::Sequence& sequence, const Report& report = {}) {
    return fragment_statistics(report, sequence).fits_note;
  };
  EXPECT_EQ(note({}), "No laws are fitted to fewer than 10 fragments.");
  EXPECT_EQ(note(broken_twice()), "No laws are fitted to fewer than 10 fragments.");
  output::Sequence few = shattered(statistics::Law::weibull, 20);
  EXPECT_EQ(note(few), "With fewer than 50 fragments the tests reject little, and no power law is fitted.");
  few.pieces[3].volume = 0;
  EXPECT_NE(note(few).find("Left out, as they have no volume: 1 of 20 fragments."), std::string::npos);
  output::Sequence equal = few;
  for (output::Piece& p : equal.pieces) p.volume = 1;
  EXPECT_EQ(note(equal), "No laws are fitted: all fragments have the same volume.");

  output::Sequence many = shattered(statistics::Law::weibull, 80);
  Report report;
  report.fractures.resize(1);
  report.fractures[0].fragments = 80;
  report.fractures[0].band_width = std::cbrt((many.pieces[3].volume + many.pieces[4].volume) / 2);
  EXPECT_EQ(note(many, report), "Smaller than the cube of the damage band, so decided by the grid: 3 of 80 fragments.");
  many.pieces[7].body = "plate";
  EXPECT_EQ(note(many), "Fragments of 2 bodies are in one sample.");

  // Two sizes only: no law has a gap.
  output::Sequence gap = shattered(statistics::Law::weibull, 80);
  for (output::Piece& p : gap.pieces) p.volume = (p.id % 2 == 0 ? 1 : 1e-6) * (1 + 1e-3 * p.id);
  EXPECT_NE(note(gap).find("contradict"), std::string::npos);
}

TEST(FragmentStatistics, NothingIsNullInJson) {
  const auto json = nlohmann::json::parse(to_json({}, {}))["statistics"];
  EXPECT_EQ(json["fragments"], 0);
  for (const auto& value : {json["largest_share"], json["volume"]["median"], json["energy"]["kinetic_end"]})
    EXPECT_TRUE(value.is_null());
  EXPECT_TRUE(json["fits"].is_array() && json["counts"].is_array());
}

void collect_keys(const nlohmann::json& json, std::set<std::string>& keys) {
  if (json.is_object())
    for (const auto& [key, value] : json.items()) keys.insert(key);
  for (const auto& value : json)
    if (value.is_structured()) collect_keys(value, keys);
}

TEST(FragmentStatistics, KeysAreTheDocumentedOnes) {
  Report report;
  report.fractures.resize(1);
  const auto json = nlohmann::json::parse(to_json(report, shattered(statistics::Law::weibull, 60)))["statistics"];
  std::set<std::string> keys;
  collect_keys(json, keys);
  const std::set<std::string> expected = {"fragments",
                                          "largest_share",
                                          "volume",
                                          "minimum",
                                          "median",
                                          "mean",
                                          "maximum",
                                          "closure",
                                          "body",
                                          "original",
                                          "relative_error",
                                          "counts",
                                          "time",
                                          "new",
                                          "alive",
                                          "fits",
                                          "law",
                                          "of",
                                          "count",
                                          "parameters",
                                          "name",
                                          "value",
                                          "low",
                                          "high",
                                          "ks",
                                          "p_value",
                                          "log_likelihood",
                                          "aic",
                                          "above",
                                          "fits_note",
                                          "per_fracture",
                                          "median_volume",
                                          "energy",
                                          "kinetic_start",
                                          "kinetic_end",
                                          "fracture",
                                          "lost_in_fractures"};
  EXPECT_EQ(keys, expected);
  std::ifstream in(std::string(SUNDER_SOURCE_DIR) + "/docs/report.md");
  const std::string text{std::istreambuf_iterator<char>(in), {}};
  for (const std::string& key : keys) EXPECT_NE(text.find(key), std::string::npos) << key;
  EXPECT_TRUE(json["fits"].back()["aic"].is_null());
  EXPECT_TRUE(json["fits"][0]["above"].is_null());
}

}  // namespace
}  // namespace sunder::pipeline
