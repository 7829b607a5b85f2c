/// USD text, read back by a small reader of our own and by three.js.
#include <map>
#include <sstream>
#include <stdexcept>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "output/detail/usd_names.h"
#include "output/writers.h"
#include "tests/output/example_sequence.h"
#include "tests/output/node.h"

namespace sunder::output {
namespace {

/// A prim: its own lines "name = value", blocks of samples as maps, and its children.
struct Prim {
  std::map<std::string, std::string> values;
  std::map<std::string, std::map<int, std::vector<double>>> samples;
  std::map<std::string, std::map<int, std::string>> words;  ///< samples that are tokens
  std::map<std::string, Prim> children;
};

std::string trimmed(const std::string& text) {
  const std::size_t first = text.find_first_not_of(' '), last = text.find_last_not_of(" ,");
  return first == std::string::npos ? "" : text.substr(first, last - first + 1);
}

std::vector<double> numbers_in(std::string text) {
  for (char& c : text)
    if (c == '(' || c == ')' || c == ',' || c == '[' || c == ']') c = ' ';
  std::istringstream in(text);
  std::vector<double> values;
  for (double value = 0; in >> value;) values.push_back(value);
  return values;
}

constexpr std::string_view kCustom = "custom ";

/// Reads one thing a line, as the writer lays it out.
class UsdReader {
 public:
  explicit UsdReader(const std::string& text) : in_(text) {}

  Prim read() {
    Prim root;
    std::getline(in_, line_);
    EXPECT_EQ(line_, "#usda 1.0");
    while (next())
      if (line_ == "(")
        skip_metadata(&root);
      else if (line_.starts_with("def "))
        read_prim(root);
      else if (!line_.empty())
        ADD_FAILURE() << "stray line: " << line_;
    return root;
  }

 private:
  bool next() {
    if (!std::getline(in_, line_)) return false;
    line_ = trimmed(line_);
    return true;
  }

  // Up to the closing parenthesis; into the prim if there is one.
  void skip_metadata(Prim* prim) {
    while (next() && line_ != ")")
      if (const std::size_t equals = line_.find(" = "); prim && equals != std::string::npos)
        prim->values[line_.substr(0, equals)] = line_.substr(equals + 3);
  }

  void read_prim(Prim& parent) {
    const std::size_t quote = line_.find('"'), end = line_.find('"', quote + 1);
    const auto [child, is_new] = parent.children.try_emplace(line_.substr(quote + 1, end - quote - 1));
    EXPECT_TRUE(is_new) << "two prims of one name: " << line_;
    const bool metadata_follows = line_.ends_with("(") || (next() && line_ == "(");
    if (metadata_follows) skip_metadata(nullptr), next();
    EXPECT_EQ(line_, "{");
    read_body(child->second);
  }

  void read_body(Prim& prim) {
    while (next() && line_ != "}") {
      if (line_.starts_with("def ")) {
        read_prim(prim);
      } else if (const std::size_t equals = line_.find(" = "); equals != std::string::npos) {
        const std::string name = line_.substr(0, equals), value = line_.substr(equals + 3);
        if (value == "{") {
          read_samples(prim, name.starts_with(kCustom) ? name.substr(kCustom.size()) : name);
        } else if (value.ends_with(" (")) {
          prim.values[name] = value.substr(0, value.size() - 2);
          skip_metadata(nullptr);
        } else {
          prim.values[name] = value;
        }
      } else {
        EXPECT_TRUE(line_.empty() || line_.starts_with("token outputs:") || line_.starts_with(kCustom))
            << "stray line: " << line_;
      }
    }
  }

  void read_samples(Prim& prim, const std::string& name) {
    while (next() && line_ != "}") {
      const std::size_t colon = line_.find(": ");
      const int frame = std::stoi(line_.substr(0, colon));
      const std::string value = line_.substr(colon + 2);
      if (value.starts_with("\""))
        prim.words[name][frame] = value;
      else
        prim.samples[name][frame] = numbers_in(value);
    }
  }

  std::istringstream in_;
  std::string line_;
};

Prim written(const Sequence& sequence) {
  const ScratchFolder folder;
  write_usda(sequence, folder / "fragments.usda");
  return UsdReader(read_all(folder / "fragments.usda")).read();
}

TEST(UsdWriter, StatesUnitsAxisAndFrames) {
  const Prim file = written(attributed_sequence());
  EXPECT_EQ(file.values.at("defaultPrim"), "\"example\"");
  EXPECT_EQ(file.values.at("metersPerUnit"), "1");
  EXPECT_EQ(file.values.at("upAxis"), "\"Y\"");
  EXPECT_EQ(file.values.at("startTimeCode"), "8");
  EXPECT_EQ(file.values.at("endTimeCode"), "12");
  EXPECT_EQ(file.values.at("timeCodesPerSecond"), "10");
  EXPECT_EQ(file.values.at("framesPerSecond"), "10");
}

using Samples = std::map<int, std::vector<double>>;

/// At the frame, or between two equal samples around it.
const std::vector<double>& value_at(const Samples& samples, int frame) {
  const auto next = samples.lower_bound(frame);
  if (next == samples.end()) throw std::out_of_range("no sample at or after frame " + std::to_string(frame));
  if (next->first == frame) return next->second;
  EXPECT_EQ(std::prev(next)->second, next->second) << "at " << frame;
  return next->second;
}

TEST(UsdWriter, SamplesMotionAtFrames) {
  Sequence sequence = attributed_sequence();
  for (Frame& frame : sequence.frames)
    for (PiecePose& pose : frame.poses) pose.twist = {Vec3(1, 2, frame.time), Vec3(0, frame.time, 0)};
  const Prim root = written(sequence).children.at("example");
  for (std::size_t f = 0; f < sequence.frames.size(); ++f)
    for (const auto& [piece, pose, twist] : sequence.frames[f].poses) {
      const Prim& prim = root.children.at(sequence.pieces[static_cast<std::size_t>(piece)].name);
      const int frame = 8 + static_cast<int>(f);
      const std::vector<double>& place = value_at(prim.samples.at("double3 xformOp:translate.timeSamples"), frame);
      // Nine digits of numbers below 2.
      for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(place[i], pose.position[static_cast<int>(i)], 1e-8);
      const std::vector<double>& q = value_at(prim.samples.at("quatf xformOp:orient.timeSamples"), frame);
      const Quat turned(q[0], q[1], q[2], q[3]);
      EXPECT_LT(turned.angularDistance(pose.orientation), 1e-6) << "single precision";
      const auto& velocity = value_at(prim.samples.at("vector3f sunder:velocity.timeSamples"), frame);
      const auto& spin = value_at(prim.samples.at("vector3f sunder:angularVelocity.timeSamples"), frame);
      for (std::size_t i = 0; i < 3; ++i) {
        EXPECT_EQ(static_cast<float>(velocity[i]), static_cast<float>(twist.linear[static_cast<int>(i)]));
        EXPECT_EQ(static_cast<float>(spin[i]), static_cast<float>(twist.angular[static_cast<int>(i)]));
      }
      EXPECT_EQ(prim.values.at("uniform token[] xformOpOrder"), "[\"xformOp:translate\", \"xformOp:orient\"]");
    }
  const Samples& fall = root.children.at("bar_0001").samples.at("double3 xformOp:translate.timeSamples");
  EXPECT_EQ(fall.begin()->first, 10) << "not before birth";
  EXPECT_EQ(fall.rbegin()->first, 12);
}

TEST(UsdWriter, RestsNeedTwoSamples) {
  Sequence sequence = example_sequence();
  for (int i = 0; i < 5; ++i) sequence.frames.push_back({0.5 + 0.1 * i, sequence.frames.back().poses});
  const Prim root = written(sequence).children.at("example");
  std::vector<int> frames;
  for (const auto& [frame, value] : root.children.at("bar_0001").samples.at("double3 xformOp:translate.timeSamples"))
    frames.push_back(frame);
  EXPECT_EQ(frames, (std::vector<int>{10, 11, 12, 17})) << "it comes to rest at 12";
}

/// In USD's grammar `custom` stands at an attribute's declaration, never at its samples.
TEST(UsdWriter, DeclaresCustomAttributesBeforeTheirSamples) {
  const ScratchFolder folder;
  write_usda(attributed_sequence(), folder / "fragments.usda");
  std::istringstream in(read_all(folder / "fragments.usda"));
  int declared = 0;
  for (std::string line; std::getline(in, line);) {
    const bool custom = trimmed(line).starts_with(kCustom);
    declared += custom;
    EXPECT_FALSE(custom && line.find(".timeSamples") != std::string::npos) << line;
  }
  EXPECT_GT(declared, 0);
}

TEST(UsdWriter, KeepsQuaternionsOnOneHemisphere) {
  const Prim root = written(example_sequence()).children.at("example");
  const Samples& samples = root.children.at("bar_0002").samples.at("quatf xformOp:orient.timeSamples");
  for (auto at = std::next(samples.begin()); at != samples.end(); ++at) {
    double dot = 0;
    for (std::size_t i = 0; i < 4; ++i) dot += at->second[i] * std::prev(at)->second[i];
    EXPECT_GT(dot, 0);
  }
}

TEST(UsdWriter, ShowsPiecesFromBirthToDeath) {
  const Prim root = written(example_sequence()).children.at("example");
  const std::string key = "token visibility.timeSamples";
  using Words = std::map<int, std::string>;
  EXPECT_EQ(root.children.at("bar").words.at(key), (Words{{8, "\"inherited\""}, {10, "\"invisible\""}}));
  EXPECT_EQ(root.children.at("bar_0001").words.at(key), (Words{{8, "\"invisible\""}, {10, "\"inherited\""}}));
}

TEST(UsdWriter, CarriesSurfaceAndOrigin) {
  const Sequence sequence = attributed_sequence();
  const Prim root = written(sequence).children.at("example");
  const Prim& piece = root.children.at("bar_0001");
  const Prim& mesh = piece.children.at("mesh");
  EXPECT_EQ(piece.values.at("custom int sunder:parent"), "0");
  EXPECT_EQ(piece.values.at("custom int sunder:birthFrame"), "10");
  EXPECT_EQ(piece.values.at("custom string sunder:body"), "\"bar\"");
  EXPECT_EQ(piece.values.at("custom string sunder:material"), "\"glass\"");
  EXPECT_EQ(piece.values.at("custom bool sunder:closed"), "0");
  EXPECT_EQ(root.children.at("bar").values.at("custom double sunder:deathTime"), "0.2");
  EXPECT_FALSE(piece.values.contains("custom double sunder:deathTime"));
  EXPECT_EQ(numbers_in(mesh.values.at("int[] faceVertexIndices")),
            (std::vector<double>{0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3}));
  EXPECT_EQ(numbers_in(mesh.values.at("int[] primvars:source_face")), (std::vector<double>{-1, 1, 2, 3}));
  EXPECT_EQ(numbers_in(mesh.values.at("texCoord2f[] primvars:st")).size(), 24u);
  EXPECT_EQ(numbers_in(mesh.values.at("normal3f[] normals")).size(), 36u);
  EXPECT_EQ(numbers_in(mesh.values.at("float[] primvars:damage_time"))[2], 2e-4);
  EXPECT_EQ(numbers_in(mesh.children.at("glass_inside").values.at("int[] indices")), std::vector<double>{0});
  EXPECT_EQ(numbers_in(mesh.children.at("glass_outside").values.at("int[] indices")), (std::vector<double>{1, 2, 3}));
  EXPECT_EQ(mesh.children.at("glass_inside").values.at("rel material:binding"), "</example/Materials/glass_inside>");
  EXPECT_TRUE(root.children.at("Materials").children.contains("glass_inside"));
}

TEST(UsdWriter, RefusesAPoseThatIsNotFinite) {
  const ScratchFolder folder;
  Sequence sequence = example_sequence();
  sequence.frames[3].poses[1].pose.position.x() = NAN;
  EXPECT_THROW(write_usda(sequence, folder / "file.usda"), Error);
  EXPECT_EQ(folder.file_count(), 0u);
}

TEST(UsdNames, AreIdentifiersOfTheirOwn) {
  detail::UsdNames names;
  EXPECT_EQ(names("cup_0001"), "cup_0001");
  EXPECT_EQ(names("a-b"), "a_b");
  EXPECT_EQ(names("a_b"), "a_b_2");
  EXPECT_EQ(names("a-b"), "a_b") << "a name keeps its prim";
  EXPECT_EQ(names("3rd"), "_3rd");
  EXPECT_EQ(names(""), "_");
}

/// As single precision, which the file's types have, or as they stand where they are no numbers.
std::vector<float> floats_in(const std::string& text) {
  const std::vector<double> values = numbers_in(text);
  return {values.begin(), values.end()};
}

void expect_same(const Prim& ours, const Prim& theirs, const std::string& path) {
  SCOPED_TRACE(path);
  ASSERT_EQ(ours.children.size(), theirs.children.size());
  ASSERT_EQ(ours.samples.size(), theirs.samples.size());
  EXPECT_EQ(ours.words, theirs.words);
  for (const auto& [name, value] : ours.values) {
    ASSERT_TRUE(theirs.values.contains(name)) << name;
    const std::string& other = theirs.values.at(name);
    if (floats_in(value).empty())
      EXPECT_EQ(value, other) << name;
    else
      EXPECT_EQ(floats_in(value), floats_in(other)) << name;
  }
  for (const auto& [name, samples] : ours.samples) {
    ASSERT_TRUE(theirs.samples.contains(name)) << name;
    ASSERT_EQ(samples.size(), theirs.samples.at(name).size()) << name;
    for (const auto& [frame, values] : samples) {
      const std::vector<double>& others = theirs.samples.at(name).at(frame);
      ASSERT_EQ(values.size(), others.size());
      for (std::size_t i = 0; i < values.size(); ++i)
        EXPECT_EQ(static_cast<float>(values[i]), static_cast<float>(others[i])) << name << " at " << frame;
    }
  }
  for (const auto& [name, child] : ours.children) {
    ASSERT_TRUE(theirs.children.contains(name)) << name;
    expect_same(child, theirs.children.at(name), path + "/" + name);
  }
}

TEST(UsdReadersSlow, TinyUsdzReadsEveryValue) {
  const ScratchFolder folder;
  Sequence sequence = attributed_sequence();
  for (Frame& frame : sequence.frames)
    for (PiecePose& pose : frame.poses) pose.twist = {Vec3(1.0 / 3, -9.81 * frame.time, 1e-7), Vec3(0, frame.time, 0)};
  write_usda(sequence, folder / "fragments.usda");
  const auto result = run_node("usd_layer.mjs", {folder / "fragments.usda"});
  EXPECT_EQ(result["error"], "");
  const Prim ours = UsdReader(read_all(folder / "fragments.usda")).read();
  expect_same(ours, UsdReader(result["layer"]).read(), "");
}

TEST(UsdReadersSlow, ThreeJsFindsEveryPiece) {
  const ScratchFolder folder;
  const Sequence sequence = attributed_sequence();
  write_usda(sequence, folder / "fragments.usda");
  const auto objects = run_node("usd_tree.mjs", {folder / "fragments.usda"});
  std::map<std::string, nlohmann::json> by_name;
  for (const auto& object : objects) by_name[object["name"]] = object;
  for (const Piece& piece : sequence.pieces) {
    ASSERT_TRUE(by_name.contains(piece.name)) << piece.name;
    EXPECT_EQ(by_name[piece.name]["type"], "Mesh");
    EXPECT_EQ(by_name[piece.name]["vertices"], 3 * piece.mesh.faces.size()) << "it makes corners of their own";
    EXPECT_EQ(by_name[piece.name]["uv"], true);
  }
}

}  // namespace
}  // namespace sunder::output
