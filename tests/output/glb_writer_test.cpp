/// Binary glTF, taken apart by hand: the format's chunks, the node of each piece and its animation.
#include <algorithm>
#include <cmath>
#include <cstring>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "output/writers.h"
#include "tests/output/example_sequence.h"
#include "tests/output/scratch_folder.h"

namespace sunder::output {
namespace {

using nlohmann::json;

struct Glb {
  json document;
  std::string binary;
};

std::uint32_t word(const std::string& bytes, std::size_t offset) {
  std::uint32_t value = 0;
  std::memcpy(&value, bytes.data() + offset, sizeof value);
  return value;
}

// Chunk layout: glTF 2.0 specification, section 4.4.
Glb parse(const std::string& bytes) {
  EXPECT_EQ(bytes.substr(0, 4), "glTF");
  EXPECT_EQ(word(bytes, 4), 2u);
  EXPECT_EQ(word(bytes, 8), bytes.size());
  const std::size_t length = word(bytes, 12);
  EXPECT_EQ(bytes.substr(16, 4), "JSON");
  Glb glb{json::parse(bytes.substr(20, length)), {}};
  if (20 + length == bytes.size()) return glb;
  EXPECT_EQ(length % 4, 0u);
  EXPECT_EQ(bytes.substr(24 + length, 4), std::string("BIN\0", 4));
  glb.binary = bytes.substr(28 + length, word(bytes, 20 + length));
  return glb;
}

Glb written(const Sequence& sequence) {
  const ScratchFolder folder;
  write_glb(sequence, folder / "file.glb");
  EXPECT_EQ(folder.file_count(), 1u);
  return parse(read_all(folder / "file.glb"));
}

std::vector<float> floats(const Glb& glb, int accessor_index) {
  const json& accessor = glb.document["accessors"][accessor_index];
  const json& view = glb.document["bufferViews"][accessor["bufferView"].get<int>()];
  const std::map<std::string, std::size_t> widths = {{"SCALAR", 1}, {"VEC2", 2}, {"VEC3", 3}, {"VEC4", 4}};
  std::vector<float> values(accessor["count"].get<std::size_t>() * widths.at(accessor["type"]));
  const std::size_t offset = view.value("byteOffset", 0u) + accessor.value("byteOffset", 0u);
  std::memcpy(values.data(), glb.binary.data() + offset, values.size() * sizeof(float));
  return values;
}

struct Channel {
  std::vector<float> times, values;
  std::string interpolation;
};

// Empty when the node has no such channel.
Channel channel(const Glb& glb, int node, const std::string& path) {
  const json& animation = glb.document["animations"][0];
  for (const json& candidate : animation["channels"]) {
    if (candidate["target"]["node"] != node || candidate["target"]["path"] != path) continue;
    const json& sampler = animation["samplers"][candidate["sampler"].get<int>()];
    return {floats(glb, sampler["input"]), floats(glb, sampler["output"]), sampler["interpolation"]};
  }
  return {};
}

TEST(GlbWriter, HasOneNodePerPieceWithItsProvenance) {
  const Glb glb = written(example_sequence());
  ASSERT_EQ(glb.document["nodes"].size(), 3u);
  EXPECT_EQ(glb.document["scenes"][0]["nodes"], json({0, 1, 2}));
  const json& fragment = glb.document["nodes"][1];
  EXPECT_EQ(fragment["name"], "bar_0001");
  EXPECT_EQ(fragment["extras"]["id"], 1);
  EXPECT_EQ(fragment["extras"]["parent"], 0);
  EXPECT_EQ(fragment["extras"]["generation"], 1);
  EXPECT_EQ(fragment["extras"]["birth_time"], 0.2);
  EXPECT_EQ(fragment["extras"]["volume"], 0.02);
  EXPECT_EQ(fragment["extras"]["mass"], 50);
  EXPECT_FALSE(fragment["extras"].contains("death_time"));
  EXPECT_EQ(glb.document["nodes"][0]["extras"]["death_time"], 0.2);
}

TEST(GlbWriter, SplitsOutsideFromInside) {
  const Glb glb = written(example_sequence());
  const json& primitives = glb.document["meshes"][1]["primitives"];
  ASSERT_EQ(primitives.size(), 2u);
  EXPECT_EQ(glb.document["meshes"][0]["primitives"].size(), 1u);
  EXPECT_EQ(primitives[0]["attributes"].size(), 1u) << "nothing but positions where a surface carries nothing";
  EXPECT_EQ(glb.document["accessors"][primitives[0]["indices"].get<int>()]["count"], 9);
  EXPECT_EQ(glb.document["accessors"][primitives[1]["indices"].get<int>()]["count"], 3);
  EXPECT_EQ(glb.document["materials"][primitives[0]["material"].get<int>()]["name"], "glass_outside");
  EXPECT_EQ(glb.document["materials"][primitives[1]["material"].get<int>()]["name"], "glass_inside");
  const std::vector<float> positions = floats(glb, primitives[0]["attributes"]["POSITION"]);
  EXPECT_EQ(std::count(positions.begin(), positions.end(), 0.1234567891f), 1);
}

TEST(GlbWriter, SwitchesPiecesAtTheirFrames) {
  const Glb glb = written(example_sequence());
  const Channel body = channel(glb, 0, "scale"), fragment = channel(glb, 1, "scale");
  EXPECT_EQ(body.interpolation, "STEP");
  EXPECT_EQ(body.times, (std::vector<float>{0, 0.2f}));
  EXPECT_EQ(body.values, (std::vector<float>{1, 1, 1, 0, 0, 0}));
  EXPECT_EQ(fragment.times, (std::vector<float>{0, 0.2f}));
  EXPECT_EQ(fragment.values, (std::vector<float>{0, 0, 0, 1, 1, 1}));
  EXPECT_FALSE(glb.document["nodes"][0].contains("scale"));
  EXPECT_EQ(glb.document["nodes"][1]["scale"], json({0.0, 0.0, 0.0}));
}

TEST(GlbWriter, SamplesMotionWhereAPieceIsAlive) {
  const Sequence sequence = example_sequence();
  const Glb glb = written(sequence);
  const Channel fall = channel(glb, 1, "translation"), turn = channel(glb, 1, "rotation");
  EXPECT_EQ(fall.times, (std::vector<float>{0.2f, static_cast<float>(0.1 * 3), 0.4f}));
  EXPECT_EQ(fall.interpolation, "LINEAR");
  ASSERT_EQ(fall.values.size(), 9u);
  EXPECT_EQ(fall.values[4], static_cast<float>(sequence.frames[3].poses[0].pose.position.y()));
  ASSERT_EQ(turn.values.size(), 12u);
  EXPECT_EQ(turn.values[2], static_cast<float>(std::sin(0.2)));  // z of a turn by 0.4 about Z
  EXPECT_EQ(turn.values[3], static_cast<float>(std::cos(0.2)));
  EXPECT_TRUE(channel(glb, 2, "translation").times.empty()) << "a piece that stays needs no channel";
}

TEST(GlbWriter, KeepsQuaternionsOnOneHemisphere) {
  const Channel turn = channel(written(example_sequence()), 2, "rotation");
  ASSERT_EQ(turn.values.size(), 12u);
  for (std::size_t i = 4; i < turn.values.size(); i += 4) {
    float dot = 0;
    for (std::size_t k = 0; k < 4; ++k) dot += turn.values[i + k] * turn.values[i + k - 4];
    EXPECT_GT(dot, 0);
  }
}

TEST(GlbWriter, StatesTheRangeOfPositionsAndTimes) {
  const Glb glb = written(example_sequence());
  for (const json& mesh : glb.document["meshes"]) {
    const json& accessor = glb.document["accessors"][mesh["primitives"][0]["attributes"]["POSITION"].get<int>()];
    EXPECT_EQ(accessor["min"], json({0.0, 0.0, 0.0}));
    EXPECT_EQ(accessor["max"][2].get<float>(), 0.1234567891f);
  }
}

TEST(GlbWriter, WritesASequenceOfOneFrameWithoutAnimation) {
  Sequence sequence = example_sequence();
  sequence.frames.resize(1);
  sequence.pieces.resize(1);
  const Glb glb = written(sequence);
  EXPECT_FALSE(glb.document.contains("animations"));
  EXPECT_EQ(glb.document["nodes"][0]["translation"], json({0.0, 1.0, 0.0}));
}

TEST(GlbWriter, WritesAnEmptySequence) {
  Sequence sequence;
  sequence.name = "empty";
  const json document = written(sequence).document;
  EXPECT_FALSE(document.contains("nodes"));
  EXPECT_EQ(document["scenes"][0]["name"], "empty");
}

TEST(GlbWriter, CarriesWhatTheSurfaceCarries) {
  const Glb glb = written(attributed_sequence());
  const json& primitives = glb.document["meshes"][1]["primitives"];
  const json& outside = primitives[0]["attributes"];
  const json& inside = primitives[1]["attributes"];
  EXPECT_FALSE(outside.contains("_DAMAGE_TIME")) << "no crack, no time";
  EXPECT_EQ(floats(glb, inside["_DAMAGE_TIME"]), (std::vector<float>{1e-4f, 1e-4f, 2e-4f}));
  EXPECT_EQ(floats(glb, inside["TEXCOORD_0"]), (std::vector<float>{0, 1, 0.75f, 0.9f, 0.5f, 0})) << "v points down";
  EXPECT_EQ(floats(glb, inside["NORMAL"]), (std::vector<float>{0, 0, -1, 0, 0, -1, 0, 0, -1}));
  EXPECT_EQ(floats(glb, outside["NORMAL"]).size(), 27u) << "three faces with normals of their own share no corner";
  const json& extras = glb.document["nodes"][1]["extras"];
  EXPECT_EQ(extras["birth_frame"], 10);
  EXPECT_EQ(extras["material"], "glass");
}

TEST(GlbWriter, MergesCornersThatCarryTheSame) {
  Sequence sequence = example_sequence();
  sequence.frames.resize(1);
  sequence.pieces.resize(1);
  const Glb glb = written(sequence);
  const json& attributes = glb.document["meshes"][0]["primitives"][0]["attributes"];
  EXPECT_EQ(floats(glb, attributes["POSITION"]).size(), 12u);
}

TEST(GlbWriter, RestsNeedTwoKeys) {
  Sequence sequence = example_sequence();
  for (Frame& frame : sequence.frames)
    for (PiecePose& pose : frame.poses)
      pose.pose = {Vec3(frame.time < 0.25 ? frame.time : 0.25, 0, 0), Quat::Identity()};
  const Glb glb = written(sequence);
  const Channel slide = channel(glb, 1, "translation");
  EXPECT_EQ(slide.times, (std::vector<float>{0.2f, static_cast<float>(0.1 * 3), 0.4f}));
  for (int i = 0; i < 20; ++i) sequence.frames.push_back({0.5 + 0.1 * i, sequence.frames.back().poses});
  EXPECT_EQ(channel(written(sequence), 1, "translation").times,
            (std::vector<float>{0.2f, static_cast<float>(0.1 * 3), 2.4f}));
}

TEST(GlbWriter, UsesWideIndicesForLargePieces) {
  Sequence sequence = example_sequence();
  sequence.pieces[0].mesh.vertices.resize(70'000, Vec3::Zero());
  for (int v = 0; v + 2 < 70'000; v += 3) sequence.pieces[0].mesh.faces.push_back({v, v + 1, v + 2});
  const std::size_t faces = sequence.pieces[0].mesh.faces.size();
  sequence.pieces[0].source_face.resize(faces);
  sequence.pieces[0].surface.material.resize(faces);
  const Glb glb = written(sequence);
  const int indices = glb.document["meshes"][0]["primitives"][0]["indices"];
  constexpr int kUnsignedInt = 5125, kUnsignedShort = 5123;
  EXPECT_EQ(glb.document["accessors"][indices]["componentType"], kUnsignedInt);
  const int small = glb.document["meshes"][1]["primitives"][0]["indices"];
  EXPECT_EQ(glb.document["accessors"][small]["componentType"], kUnsignedShort);
}

TEST(GlbWriter, RefusesAPoseThatIsNotFinite) {
  const ScratchFolder folder;
  Sequence sequence = example_sequence();
  sequence.frames[3].poses[1].pose.orientation.x() = INFINITY;
  EXPECT_THROW(write_glb(sequence, folder / "file.glb"), Error);
  EXPECT_EQ(folder.file_count(), 0u);
}

}  // namespace
}  // namespace sunder::output
