/// GLB files as others read them: the Khronos validator and three.js.
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "geometry/primitives.h"
#include "output/atomic_file.h"
#include "output/writers.h"
#include "tests/output/example_sequence.h"
#include "tests/output/node.h"

namespace sunder::output {
namespace {

using nlohmann::json;

json expected_frames(const Sequence& sequence, const std::vector<std::size_t>& frames) {
  json expected = {{"frames", json::array()}};
  for (const std::size_t f : frames) {
    json pieces = json::object();
    for (const auto& [piece, pose, twist] : sequence.frames[f].poses) {
      const Eigen::Vector4d q = pose.orientation.normalized().coeffs();
      pieces[sequence.pieces[static_cast<std::size_t>(piece)].name] = {
          {"position", {pose.position.x(), pose.position.y(), pose.position.z()}},
          {"orientation", {q[0], q[1], q[2], q[3]}}};
    }
    expected["frames"].push_back({{"time", sequence.frames[f].time - sequence.frames[0].time}, {"pieces", pieces}});
  }
  return expected;
}

void expect_clean_and_exact(const Sequence& sequence, const std::vector<std::size_t>& frames) {
  const ScratchFolder folder;
  write_glb(sequence, folder / "file.glb");
  write_atomically(folder / "expected.json", expected_frames(sequence, frames).dump());
  const json result = run_node("glb_check.mjs", {folder / "file.glb", folder / "expected.json"});
  for (const char* kind : {"errors", "warnings", "infos", "hints"}) EXPECT_EQ(result[kind], 0) << result["messages"];
  EXPECT_EQ(result["differences"], json::array());
}

/// Many pieces that fall and turn, each born and dead at another frame.
Sequence many_pieces(int count, int frames) {
  Sequence sequence;
  sequence.name = "many";
  sequence.frame_rate = 24;
  sequence.frames.resize(static_cast<std::size_t>(frames));
  for (int i = 0; i < count; ++i) {
    Piece piece = attributed_piece(i, fragment_name("many", i), i == 0 ? -1 : 0);
    const int born = i % (frames / 2), dead = i % 3 == 0 ? frames : frames - i % (frames / 3);
    for (int f = born; f < dead; ++f) {
      const double t = f / 24.0, rest = std::min(t, 1.5 + 0.01 * i);
      const Pose pose{Vec3(0.1 * i, 2 - rest * rest, std::sin(0.37 * i)),
                      Quat(Eigen::AngleAxisd(rest * (1 + 0.1 * i), Vec3(1, 0.3 * i, -2).normalized()))};
      sequence.frames[static_cast<std::size_t>(f)].time = t;
      sequence.frames[static_cast<std::size_t>(f)].poses.push_back({i, pose, {}});
    }
    sequence.pieces.push_back(std::move(piece));
  }
  for (int f = 0; f < frames; ++f) sequence.frames[static_cast<std::size_t>(f)].time = f / 24.0;
  return sequence;
}

TEST(GlbReadersSlow, AgreeOnTheExample) { expect_clean_and_exact(example_sequence(), {0, 1, 2, 4}); }

TEST(GlbReadersSlow, AgreeOnPiecesThatCarryEverything) { expect_clean_and_exact(attributed_sequence(), {0, 2, 3}); }

TEST(GlbReadersSlow, AgreeOnASingleFrame) {
  Sequence sequence = attributed_sequence();
  sequence.frames.resize(1);
  sequence.pieces.resize(1);
  expect_clean_and_exact(sequence, {0});
}

TEST(GlbReadersSlow, AgreeOnAThousandPieces) { expect_clean_and_exact(many_pieces(1000, 48), {3, 24, 47}); }

TEST(GlbReadersSlow, AcceptAnEmptySequence) {
  Sequence sequence;
  sequence.name = "empty";
  expect_clean_and_exact(sequence, {});
}

}  // namespace
}  // namespace sunder::output
