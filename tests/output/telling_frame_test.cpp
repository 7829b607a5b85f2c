/// The frame that a still shows, by sequences whose openings are known.
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "geometry/primitives.h"
#include "output/poster.h"

namespace sunder::output {
namespace {

Piece box_piece(int id, const Vec3& size, int parent) {
  Piece piece;
  piece.id = id;
  piece.body = "cube";
  piece.parent = parent;
  piece.mesh = geometry::box(size);
  piece.volume = size.prod();
  return piece;
}

/// Two halves of a cube from -1/2 to 1/2 go apart, each by `speed` a frame, from frame `broken` on.
Sequence parting_halves(std::size_t frames, std::size_t broken, double speed) {
  Sequence sequence;
  sequence.pieces = {box_piece(0, {1, 1, 1}, -1), box_piece(1, {0.5, 1, 1}, 0), box_piece(2, {0.5, 1, 1}, 0)};
  for (std::size_t f = 0; f < frames; ++f) {
    Frame& frame = sequence.frames.emplace_back();
    if (f < broken) {
      frame.poses = {{0, {}, {}}};
      continue;
    }
    const Vec3 place((0.25 + speed * static_cast<double>(f - broken)), 0, 0);
    frame.poses = {{1, {-place, Quat::Identity()}, {}}, {2, {place, Quat::Identity()}, {}}};
  }
  return sequence;
}

TEST(TellingFrame, HalvesOfACubeAreShownWhenTheirGyrationHasGrownByThreeTenths) {
  // The square of the cube's radius of gyration is 1/4. Halves that went x each make it 1/4 - 1/16 + (1/4 + x)^2, which
  // is 1.3^2 / 4 at x = 0.235: 0.03 a frame go there in 7.8 frames.
  EXPECT_EQ(telling_frame(parting_halves(60, 5, 0.03)), 13u);
  EXPECT_EQ(telling_frame(parting_halves(60, 20, 0.03)), 28u);
}

TEST(TellingFrame, IsTheFirstWithFragmentsWhenTheyFlyOffAtOnce) {
  Sequence sequence = parting_halves(10, 4, 5);
  sequence.frames.erase(sequence.frames.begin() + 4);  // the frame in which they still touch
  EXPECT_EQ(telling_frame(sequence), 4u);
}

TEST(TellingFrame, PrefersMoreFragmentsAtTheSameOpening) {
  Sequence sequence = parting_halves(30, 5, 0.03);
  // In the last frame there are two more cubes in halves, opened as much as the first was in its best frame.
  for (const std::string name : {"second", "third"}) {
    const int id = static_cast<int>(sequence.pieces.size());
    for (int part = 0; part < 3; ++part) {
      sequence.pieces.push_back(sequence.pieces[static_cast<std::size_t>(part)]);
      sequence.pieces.back().id = id + part;
      sequence.pieces.back().body = name;
    }
    for (const PiecePose& pose : std::vector<PiecePose>(sequence.frames[13].poses))
      sequence.frames.back().poses.push_back({id + pose.piece, pose.pose, {}});
  }
  EXPECT_EQ(telling_frame(sequence), 29u);
}

TEST(TellingFrame, IsTheLastWhereNothingBreaks) {
  EXPECT_EQ(telling_frame(parting_halves(12, 12, 0)), 11u);
  EXPECT_EQ(telling_frame(Sequence{}), 0u);
}

RC_GTEST_PROP(TellingFrame, DoesNotDependOnPlaceSizeOrWhatStandsStill, (int turn, int shift, int power)) {
  Sequence sequence = parting_halves(40, 7, 0.02);
  const std::size_t expected = telling_frame(sequence);
  const double scale = std::pow(10.0, power % 4);
  const Quat rotation(Eigen::AngleAxisd(turn % 360 * 0.0175, Vec3(1, 2, 3).normalized()));
  for (Piece& piece : sequence.pieces) {
    for (Vec3& x : piece.mesh.vertices) x *= scale;
    piece.volume *= scale * scale * scale;
  }
  Piece wall = box_piece(3, Vec3(50, 50, 1) * scale, -1);
  wall.body = "wall";
  sequence.pieces.push_back(wall);
  for (Frame& frame : sequence.frames) {
    for (PiecePose& pose : frame.poses)
      pose.pose = {scale * (rotation * pose.pose.position) + Vec3(shift % 10 * scale, 0, 0), rotation};
    frame.poses.push_back({3, {}, {}});
  }
  RC_ASSERT(telling_frame(sequence) == expected);
}

}  // namespace
}  // namespace sunder::output
