/// OBJ frames, read back by the geometry module and by eye.
#include <cmath>

#include <gtest/gtest.h>

#include "core/error.h"
#include "geometry/load.h"
#include "geometry/mass_properties.h"
#include "output/writers.h"
#include "tests/output/example_sequence.h"
#include "tests/output/scratch_folder.h"

namespace sunder::output {
namespace {

// Nine significant digits of a coordinate of order one.
constexpr double kNineDigits = 5e-9;

void write_frame(const Sequence& sequence, std::size_t frame, const std::filesystem::path& dir) {
  ObjFrames().write(sequence, frame, dir);
}

int count(const std::string& text, const std::string& part) {
  int found = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++found;
  return found;
}

TEST(ObjWriter, NamesFilesByFrameNumber) {
  const ScratchFolder folder;
  Sequence sequence = example_sequence();
  write_frame(sequence, 0, folder.path());
  write_obj_materials(sequence, folder.path());
  EXPECT_TRUE(std::filesystem::exists(folder / "example.0008.obj"));
  EXPECT_TRUE(std::filesystem::exists(folder / "example.mtl"));
  sequence.start_frame = 9998;
  write_frame(sequence, 2, folder.path());
  EXPECT_TRUE(std::filesystem::exists(folder / "example.10000.obj"));
  EXPECT_EQ(folder.file_count(), 3u);
}

TEST(ObjWriter, WritesPiecesAndMaterials) {
  const ScratchFolder folder;
  const Sequence sequence = example_sequence();
  write_frame(sequence, 0, folder.path());
  write_frame(sequence, 3, folder.path());
  write_obj_materials(sequence, folder.path());
  const std::string first = read_all(folder / "example.0008.obj"), text = read_all(folder / "example.0011.obj");
  EXPECT_EQ(count(first, "\no "), 1);
  EXPECT_EQ(count(first, "_inside"), 0);
  EXPECT_EQ(count(text, "\no bar_0001\n"), 1);
  EXPECT_EQ(count(text, "\no bar_0002\n"), 1);
  EXPECT_EQ(count(text, "usemtl glass_inside\n"), 2);
  EXPECT_EQ(count(text, "usemtl glass_outside\n"), 2);
  EXPECT_EQ(count(text, "\nf "), 8);
  EXPECT_EQ(count(text, "\nv "), 8);
  EXPECT_NE(text.find("\nf 5 7 6\n"), std::string::npos) << "the second piece's vertices follow the first's";
  const std::string materials = read_all(folder / "example.mtl");
  EXPECT_EQ(count(materials, "newmtl glass_outside\n") + count(materials, "newmtl glass_inside\n"), 2);
}

TEST(ObjWriter, AppliesPosesToNineDigits) {
  const ScratchFolder folder;
  const Sequence sequence = example_sequence();
  write_frame(sequence, 1, folder.path());
  const std::string text = read_all(folder / "example.0009.obj");
  std::istringstream in(text.substr(text.find("\nv ")));
  for (const Vec3& vertex : sequence.pieces[0].mesh.vertices) {
    std::string tag;
    Vec3 x;
    in >> tag >> x.x() >> x.y() >> x.z();
    EXPECT_LT((x - sequence.frames[1].poses[0].pose * vertex).lpNorm<Eigen::Infinity>(), kNineDigits);
  }
}

TEST(ObjWriter, IsReadBackAsTheSameSolids) {
  const ScratchFolder folder;
  write_frame(example_sequence(), 3, folder.path());
  const geometry::TriangleMesh mesh = geometry::load_mesh(folder / "example.0011.obj");
  const double expected = 2 * 0.1234567891 / 6;
  EXPECT_NEAR(geometry::mass_properties(mesh).volume, expected, 10 * kNineDigits);
}

TEST(ObjWriter, SameSequenceSameBytes) {
  const ScratchFolder folder;
  write_frame(example_sequence(), 2, folder.path());
  const std::string once = read_all(folder / "example.0010.obj");
  write_frame(example_sequence(), 2, folder.path());
  EXPECT_EQ(read_all(folder / "example.0010.obj"), once);
}

/// What a frame shows does not depend on what was written before it.
TEST(ObjWriter, KeptTextIsTheTextOfANewWriter) {
  const ScratchFolder folder;
  const std::filesystem::path kept = folder / "kept", anew = folder / "anew";
  std::filesystem::create_directory(kept);
  std::filesystem::create_directory(anew);
  Sequence sequence = attributed_sequence();
  sequence.frames.push_back({0.5, {sequence.frames[3].poses[1]}});  // the first fragment is gone: numbers move
  ObjFrames frames;
  for (const std::size_t f : {0u, 1u, 2u, 3u, 5u, 4u, 0u}) {
    frames.write(sequence, f, kept);
    write_frame(sequence, f, anew);
    const std::string name = "example." + frame_number(8 + static_cast<long>(f)) + ".obj";
    EXPECT_EQ(read_all(kept / name), read_all(anew / name)) << name;
  }
}

TEST(ObjWriter, RefusesAPoseThatIsNotFinite) {
  const ScratchFolder folder;
  Sequence sequence = example_sequence();
  sequence.frames[0].poses[0].pose.position.x() = std::nan("");
  EXPECT_THROW(write_frame(sequence, 0, folder.path()), Error);
  EXPECT_FALSE(std::filesystem::exists(folder / "example.0008.obj"));
}

TEST(ObjWriter, MissingFolderIsAnIoError) {
  const ScratchFolder folder;
  try {
    write_frame(example_sequence(), 0, folder / "nowhere");
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::io);
  }
}

TEST(ObjWriter, CarriesTextureAndNormalsPerCorner) {
  const ScratchFolder folder;
  const Sequence sequence = attributed_sequence();
  write_frame(sequence, 3, folder.path());
  const std::string text = read_all(folder / "example.0011.obj");
  EXPECT_EQ(count(text, "\nvt "), 24) << "two pieces of four faces with corners of their own";
  EXPECT_EQ(count(text, "\nvn "), 24);
  EXPECT_NE(text.find("\nvt 0.75 0.1\n"), std::string::npos) << "v points up";
  EXPECT_NE(text.find("\nf 1/10/10 3/11/11 2/12/12\n"), std::string::npos) << "the crack face comes last";
  EXPECT_NE(text.find("\nf 5/22/22 7/23/23 6/24/24\n"), std::string::npos);
  // The crack face's normal -Z turns with the piece about Z; that of a side does not stay.
  EXPECT_EQ(count(text, "\nvn 0 0 -1\n") + count(text, "\nvn -0 0 -1\n") + count(text, "\nvn 0 -0 -1\n"), 6);
}

TEST(ObjWriter, PadsNumbersBehindTheSign) {
  EXPECT_EQ(frame_number(7), "0007");
  EXPECT_EQ(frame_number(-7), "-0007");
  EXPECT_EQ(frame_number(123456), "123456");
}

}  // namespace
}  // namespace sunder::output
