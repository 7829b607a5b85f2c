/// Transform tables and PLY frames, read back.
#include <cstring>
#include <sstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "output/writers.h"
#include "tests/output/example_sequence.h"
#include "tests/output/scratch_folder.h"

namespace sunder::output {
namespace {

Sequence moving_sequence() {
  Sequence sequence = attributed_sequence();
  for (Frame& frame : sequence.frames)
    for (PiecePose& pose : frame.poses)
      pose.twist = {Vec3(0.1, -9.81 * frame.time, pose.piece), Vec3(1.0 / 3, 0, -frame.time)};
  return sequence;
}

std::vector<double> numbers_of(const PiecePose& pose) {
  std::vector<double> values;
  const auto add = [&](const auto& vector) { values.insert(values.end(), vector.begin(), vector.end()); };
  add(pose.pose.position);
  add(pose.pose.orientation.coeffs());
  add(pose.twist.linear);
  add(pose.twist.angular);
  return values;
}

TEST(Transforms, CsvHoldsEveryPoseToTheLastBit) {
  const ScratchFolder folder;
  const Sequence sequence = moving_sequence();
  write_transforms_csv(sequence, folder / "transforms.csv");
  std::istringstream in(read_all(folder / "transforms.csv"));
  std::string line;
  std::getline(in, line);
  EXPECT_EQ(line, "frame,time_s,id,name,x_m,y_m,z_m,qx,qy,qz,qw,vx_m_s,vy_m_s,vz_m_s,wx_rad_s,wy_rad_s,wz_rad_s");
  for (std::size_t f = 0; f < sequence.frames.size(); ++f)
    for (const PiecePose& pose : sequence.frames[f].poses) {
      ASSERT_TRUE(std::getline(in, line));
      std::istringstream row(line);
      std::vector<std::string> cells;
      for (std::string cell; std::getline(row, cell, ',');) cells.push_back(cell);
      ASSERT_EQ(cells.size(), 17u);
      EXPECT_EQ(cells[0], std::to_string(8 + f));
      EXPECT_EQ(std::stod(cells[1]), sequence.frames[f].time);
      EXPECT_EQ(cells[2], std::to_string(pose.piece));
      EXPECT_EQ(cells[3], sequence.pieces[static_cast<std::size_t>(pose.piece)].name);
      const std::vector<double> expected = numbers_of(pose);
      for (std::size_t i = 0; i < expected.size(); ++i) EXPECT_EQ(std::stod(cells[4 + i]), expected[i]);
    }
  EXPECT_FALSE(std::getline(in, line));
}

TEST(Transforms, JsonLinesHoldTheSame) {
  const ScratchFolder folder;
  const Sequence sequence = moving_sequence();
  write_transforms_jsonl(sequence, folder / "transforms.jsonl");
  std::istringstream in(read_all(folder / "transforms.jsonl"));
  std::string line;
  for (std::size_t f = 0; f < sequence.frames.size(); ++f)
    for (const PiecePose& pose : sequence.frames[f].poses) {
      ASSERT_TRUE(std::getline(in, line));
      const auto json = nlohmann::json::parse(line);
      EXPECT_EQ(json["frame"], 8 + f);
      EXPECT_EQ(json["time"], sequence.frames[f].time);
      EXPECT_EQ(json["id"], pose.piece);
      EXPECT_EQ(json["name"], sequence.pieces[static_cast<std::size_t>(pose.piece)].name);
      std::vector<double> values;
      for (const char* key : {"position", "orientation", "velocity", "angular_velocity"})
        for (const double value : json[key]) values.push_back(value);
      EXPECT_EQ(values, numbers_of(pose));
    }
  EXPECT_FALSE(std::getline(in, line));
}

TEST(Transforms, RefuseAPoseThatIsNotFinite) {
  const ScratchFolder folder;
  Sequence sequence = moving_sequence();
  sequence.frames[3].poses[1].twist.angular.x() = NAN;
  EXPECT_THROW(write_transforms_csv(sequence, folder / "a.csv"), Error);
  EXPECT_THROW(write_transforms_jsonl(sequence, folder / "a.jsonl"), Error);
  EXPECT_EQ(folder.file_count(), 0u);
}

/// Takes values from the front.
struct Reader {
  const char* at;
  template <class Value>
  Value take() {
    Value value;
    std::memcpy(&value, at, sizeof value);
    at += sizeof value;
    return value;
  }
};

TEST(PlyWriter, HoldsAFrameWithWhereItComesFrom) {
  const ScratchFolder folder;
  const Sequence sequence = attributed_sequence();
  write_ply_frame(sequence, 3, folder.path());
  const std::string text = read_all(folder / "example.0011.ply");
  const std::size_t end = text.find("end_header\n");
  ASSERT_NE(end, std::string::npos);
  const std::string header = text.substr(0, end);
  EXPECT_TRUE(header.starts_with("ply\nformat binary_little_endian 1.0\ncomment example, frame 11, 0.3"));
  EXPECT_NE(header.find("comment piece 2 bar_0002\n"), std::string::npos);
  EXPECT_NE(header.find("element vertex 8\n"), std::string::npos);
  EXPECT_NE(header.find("element face 8\n"), std::string::npos);
  Reader in{text.data() + end + 11};
  for (const PiecePose& pose : sequence.frames[3].poses)
    for (int v = 0; v < 4; ++v) {
      const Eigen::Vector3f expected =
          (pose.pose * sequence.pieces[1].mesh.vertices[static_cast<std::size_t>(v)]).cast<float>();
      // Rotation by matrix and by quaternion differ in the last bits of double precision.
      for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(in.take<float>(), expected[axis], 1e-7f);
      EXPECT_EQ(in.take<std::int32_t>(), pose.piece);
      EXPECT_EQ(in.take<float>(), v == 3 ? -1.0f : v == 1 ? 2e-4f : 1e-4f) << "vertex " << v;
    }
  for (int face = 0; face < 8; ++face) {
    EXPECT_EQ(in.take<std::uint8_t>(), 3);
    const int first = face < 4 ? 0 : 4;
    for (const int vertex : sequence.pieces[1].mesh.faces[static_cast<std::size_t>(face % 4)])
      EXPECT_EQ(in.take<std::int32_t>(), first + vertex);
    EXPECT_EQ(in.take<std::int32_t>(), face < 4 ? 1 : 2);
    EXPECT_EQ(in.take<std::int32_t>(), face % 4 == 0 ? -1 : face % 4);
    EXPECT_EQ(in.take<std::uint8_t>(), face % 4 == 0);
    in.at += 3;
  }
  EXPECT_EQ(in.at, text.data() + text.size());
}

}  // namespace
}  // namespace sunder::output
