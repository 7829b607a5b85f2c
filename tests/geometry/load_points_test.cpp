/// Clouds of damaged points from text, PLY and OpenVDB files, and what is said of files that are wrong.
#include "geometry/load_points.h"

#include <bit>
#include <cstring>
#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>
#include <openvdb/openvdb.h>
#include <openvdb/points/PointConversion.h>
#include <openvdb/points/PointCount.h>
#include <unistd.h>

#include "core/error.h"

namespace sunder::geometry {
namespace {

namespace fs = std::filesystem;

constexpr double kSingle = 1e-6;     // digits of numbers written in single precision
constexpr double kQuantized = 1e-4;  // of a voxel: 16 bits for the place in it

class LoadPoints : public testing::Test {
 protected:
  void SetUp() override { fs::create_directories(folder_); }
  void TearDown() override { fs::remove_all(folder_); }

  fs::path file(const std::string& name, const std::string& bytes) const {
    std::ofstream(folder_ / name, std::ios::binary) << bytes;
    return folder_ / name;
  }
  DamagedPoints text(const std::string& lines) const { return load_points(file("cloud.txt", lines)); }
  DamagedPoints ply(const std::string& bytes) const { return load_points(file("cloud.ply", bytes)); }

  /// The file is refused for this reason, and the message names the file and all `parts`.
  void expect_error(const fs::path& path, ErrorKind kind, const std::vector<std::string>& parts) const {
    try {
      load_points(path);
      ADD_FAILURE() << path << " was read";
    } catch (const Error& error) {
      const std::string message = error.what();
      EXPECT_EQ(error.kind(), kind) << message;
      EXPECT_NE(message.find(path.string()), std::string::npos) << message;
      for (const std::string& part : parts) EXPECT_NE(message.find(part), std::string::npos) << message;
    }
  }
  void refuses_text(const std::string& lines, const std::vector<std::string>& parts) const {
    expect_error(file("cloud.txt", lines), ErrorKind::usage, parts);
  }
  void refuses_ply(const std::string& bytes, const std::vector<std::string>& parts) const {
    expect_error(file("cloud.ply", bytes), ErrorKind::usage, parts);
  }

  const fs::path folder_ = fs::path(testing::TempDir()) / ("sunder_load_points_" + std::to_string(getpid()));
};

TEST_F(LoadPoints, TextTakesAnySeparatorsCommentsAndAHeader) {
  const std::vector<std::string> same = {
      "1 2 3 0.5\n-4 5e-1 6 1\n",
      "1 2 3 0.5\n-4 5e-1 6 1",  // no newline at the end
      "1,2,3,0.5\n-4,5e-1,6,1\n",
      "1;2;3;0.5\n-4;5e-1;6;1\n",
      "1\t2\t3\t0.5\n-4\t5e-1\t6\t1\n",
      "  1 , 2 , 3 , 0.5  \n  -4 , 5e-1 , 6 , 1 \n",
      "1 2 3 0.5\r\n-4 5e-1 6 1\r\n",
      "+1 +2 3 +0.5\n-4 +5e-1 6 1\n",
      "# made by a solver\n\n1 2 3 0.5\n   \n  # half way\n-4 5e-1 6 1\n\n",
      "x y z damage\n1 2 3 0.5\n-4 5e-1 6 1\n",
      "# comment first\r\nx,y,z,damage\r\n1,2,3,0.5\r\n-4,5e-1,6,1\r\n",
      "\"x\",\"y\",\"z\",\"damage\"\n1,2,3,0.5\n-4,5e-1,6,1\n",
      "\xEF\xBB\xBF"
      "1 2 3 0.5\n-4 5e-1 6 1\n",  // the mark that spreadsheets put in front
      "\xEF\xBB\xBF"
      "x y z damage\n1 2 3 0.5\n-4 5e-1 6 1\n",
  };
  for (const std::string& lines : same) {
    const DamagedPoints cloud = text(lines);
    ASSERT_EQ(cloud.points.size(), 2u) << lines;
    EXPECT_EQ(cloud.points[0], Vec3(1, 2, 3)) << lines;
    EXPECT_EQ(cloud.points[1], Vec3(-4, 0.5, 6)) << lines;
    EXPECT_EQ(cloud.damage, (std::vector<double>{0.5, 1})) << lines;
    EXPECT_TRUE(cloud.damage_time.empty()) << lines;
  }
}

TEST_F(LoadPoints, AFifthColumnIsTheTime) {
  const DamagedPoints cloud = text("x y z damage damage_time\n0 0 0 1 2.5e-6\n0 0 1 0 -1\n");
  EXPECT_EQ(cloud.damage_time, (std::vector<double>{2.5e-6, -1}));
}

TEST_F(LoadPoints, TheExtensionOfTextIsFree) {
  EXPECT_EQ(load_points(file("cloud.csv", "0,0,0,1\n")).points.size(), 1u);
  EXPECT_EQ(load_points(file("cloud", "0 0 0 1\n")).points.size(), 1u);
}

TEST_F(LoadPoints, TextThatIsWrongIsNamedWithItsLine) {
  refuses_text("0 0 0 1\n0 0 1\n", {"line 2", "3 numbers", "x y z damage"});
  refuses_text("# c\n0 0 0 1 2 3\n", {"line 2", "6 numbers"});
  refuses_text("0 0 0 1\n\n0 0 0 1 5\n", {"line 3", "4 numbers"});
  refuses_text("0 0 0 1 5\n0 0 0 1\n", {"line 2", "5 numbers"});
  refuses_text("0 0 0 1\nx y z damage\n", {"line 2", "not a line of numbers", "x y z damage"});
  refuses_text("x y z damage\nm m m 1\n", {"line 2", "not a line of numbers"});
  refuses_text("0 0 0 1\n0 0 0x 1\n", {"line 2", "0x"});
  refuses_text("0 0 0 1\n0 0 + 1\n", {"line 2"});
}

TEST_F(LoadPoints, AFirstLineThatBeginsWithNumbersIsNoHeader) {
  refuses_text("0 0 0 1.0.0\n0 0 0 1\n", {"line 1", "not a line of numbers"});
  refuses_text("0 0 0 one\n0 0 0 1\n", {"line 1"});
}

TEST_F(LoadPoints, DamageIsClampedWithinRounding) {
  const DamagedPoints cloud = text("0 0 0 1.0000001\n0 0 0 -0.0000001\n0 0 0 1\n");
  EXPECT_EQ(cloud.damage, (std::vector<double>{1, 0, 1}));
  refuses_text("0 0 0 1\n0 0 0 1.1\n", {"point 2", "1.1", "between 0 and 1"});
  refuses_text("0 0 0 -0.1\n", {"point 1", "between 0 and 1"});
  refuses_text("0 0 0 1.000002\n", {"point 1", "between 0 and 1"});
}

TEST_F(LoadPoints, NumbersMustBeFinite) {
  refuses_text("0 0 0 nan\n", {"point 1", "between 0 and 1"});
  refuses_text("0 0 0 inf\n", {"point 1"});
  refuses_text("0 0 0 1\n0 nan 0 1\n", {"point 2", "not finite"});
  refuses_text("inf 0 0 1\n", {"point 1", "not finite"});
  refuses_text("0 0 0 1 nan\n", {"point 1", "-1 for never"});
  refuses_text("0 0 0 1 inf\n", {"point 1", "-1 for never"});
}

TEST_F(LoadPoints, AFileWithoutPointsIsRefused) {
  refuses_text("", {"no points"});
  refuses_text("\n", {"no points"});
  refuses_text("# nothing\n", {"no points"});
  refuses_text("x y z damage\n", {"no points"});
}

TEST_F(LoadPoints, AFileThatIsNotThereIsAnIoError) {
  for (const char* name : {"none.txt", "none.ply", "none.vdb"}) expect_error(folder_ / name, ErrorKind::io, {});
  fs::create_directories(folder_ / "folder.txt");
  expect_error(folder_ / "folder.txt", ErrorKind::io, {});
}

std::string ply_header(const std::string& format, const std::string& type, int vertices, const std::string& more = "") {
  std::string header =
      "ply\nformat " + format + " 1.0\ncomment of a solver\nelement vertex " + std::to_string(vertices) + "\n";
  for (const char* name : {"x", "y", "z", "damage"}) header += "property " + type + " " + name + "\n";
  return header + more + "end_header\n";
}

template <typename Number>
void append(std::string& bytes, Number value) {
  static_assert(std::endian::native == std::endian::little);
  char raw[sizeof value];
  std::memcpy(raw, &value, sizeof value);
  bytes.append(raw, sizeof value);
}

TEST_F(LoadPoints, PlyInAscii) {
  const DamagedPoints cloud = ply(ply_header("ascii", "float", 2) + "1 2 3 0.5\n-4 0.5 6 1\n");
  ASSERT_EQ(cloud.points.size(), 2u);
  EXPECT_EQ(cloud.points[1], Vec3(-4, 0.5, 6));
  EXPECT_EQ(cloud.damage, (std::vector<double>{0.5, 1}));
  EXPECT_TRUE(cloud.damage_time.empty());
}

TEST_F(LoadPoints, PlyInAsciiWithWindowsLines) {
  std::string bytes;
  for (const char c : ply_header("ascii", "float", 1) + "1 2 3 0.5\n") bytes += c == '\n' ? "\r\n" : std::string(1, c);
  EXPECT_EQ(ply(bytes).points.at(0), Vec3(1, 2, 3));
}

TEST_F(LoadPoints, TheExtensionOfPlyMayBeInCapitals) {
  EXPECT_EQ(load_points(file("cloud.PLY", ply_header("ascii", "float", 1) + "1 2 3 0.5\n")).points.size(), 1u);
}

TEST_F(LoadPoints, PlyWithFurtherPropertiesInAnyOrderAndFacesAfter) {
  const std::string bytes =
      "ply\nformat ascii 1.0\nelement vertex 2\nproperty float damage_time\nproperty uchar red\nproperty float z\n"
      "property float y\nproperty float damage\nproperty float x\nelement face 1\nproperty list uchar int "
      "vertex_indices\nend_header\n3e-6 255 3 2 0.5 1\n-1 0 6 5 1 4\n3 0 1 0\n";
  const DamagedPoints cloud = ply(bytes);
  ASSERT_EQ(cloud.points.size(), 2u);
  EXPECT_EQ(cloud.points[0], Vec3(1, 2, 3));
  EXPECT_EQ(cloud.points[1], Vec3(4, 5, 6));
  EXPECT_EQ(cloud.damage, (std::vector<double>{0.5, 1}));
  EXPECT_EQ(cloud.damage_time, (std::vector<double>{3e-6, -1}));
}

TEST_F(LoadPoints, BinaryPlyOfDoubles) {
  std::string bytes = ply_header("binary_little_endian", "double", 2);
  for (const double value : {0.1, 0.2, 0.3, 0.4, -1e-9, 1e9, 7.0, 1.0}) append(bytes, value);
  const DamagedPoints cloud = ply(bytes);
  ASSERT_EQ(cloud.points.size(), 2u);
  EXPECT_EQ(cloud.points[0], Vec3(0.1, 0.2, 0.3));
  EXPECT_EQ(cloud.points[1], Vec3(-1e-9, 1e9, 7));
  EXPECT_EQ(cloud.damage, (std::vector<double>{0.4, 1}));
}

TEST_F(LoadPoints, BinaryPlyOfMixedTypesWithFacesAfter) {
  std::string bytes =
      "ply\nformat binary_little_endian 1.0\nelement vertex 2\nproperty float x\nproperty uchar red\n"
      "property float y\nproperty short layer\nproperty float z\nproperty float damage\n"
      "property double damage_time\nelement face 1\nproperty list uchar int vertex_indices\n"
      "end_header\n";
  for (int i = 0; i < 2; ++i) {
    append(bytes, 0.1f + static_cast<float>(i));
    append(bytes, std::uint8_t{200});
    append(bytes, 0.2f);
    append(bytes, std::int16_t{-300});
    append(bytes, 0.3f);
    append(bytes, 1.0f);
    append(bytes, 1.5e-5 * i);
  }
  bytes += '\3';
  for (const int v : {0, 1, 0}) append(bytes, v);
  const DamagedPoints cloud = ply(bytes);
  ASSERT_EQ(cloud.points.size(), 2u);
  EXPECT_NEAR((cloud.points[1] - Vec3(1.1, 0.2, 0.3)).norm(), 0, kSingle);
  EXPECT_EQ(cloud.damage, (std::vector<double>{1, 1}));
  EXPECT_EQ(cloud.damage_time, (std::vector<double>{0, 1.5e-5}));
}

TEST_F(LoadPoints, PlyThatIsWrongIsNamed) {
  const std::string one = "1 2 3 0.5\n";
  refuses_ply("", {"no points"});
  refuses_ply("obj\n", {"not a PLY"});
  refuses_ply("ply\nformat ascii 1.0\nelement vertex 1\n", {"header has no end"});
  refuses_ply(ply_header("binary_big_endian", "float", 1) + one, {"binary_big_endian", "not supported"});
  refuses_ply(ply_header("ascii", "half", 1) + one, {"'half'", "not supported"});
  refuses_ply(ply_header("ascii", "float", 1, "property list uchar int next\n") + one, {"'list'", "not supported"});
  refuses_ply(ply_header("ascii", "float", 2) + one, {"vertex 2 of 2"});
  refuses_ply(ply_header("binary_little_endian", "double", 2) + std::string(63, '\0'), {"vertex 2 of 2"});
  refuses_ply(ply_header("ascii", "float", 1) + "1 2 three 0.5\n", {"vertex 1 of 1"});
  refuses_ply(ply_header("ascii", "float", 0), {"no points"});
  refuses_ply(ply_header("ascii", "float", 1) + "1 2 3 1.5\n", {"point 1", "between 0 and 1"});
  refuses_ply(ply_header("ascii", "float", 1) + "1 nan 3 1\n", {"point 1", "not finite"});
  refuses_ply(
      "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n"
      "end_header\n1 2 3\n",
      {"'damage'"});
  refuses_ply(
      "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float z\nproperty float damage\n"
      "end_header\n1 2 3\n",
      {"'y'"});
  refuses_ply("ply\nformat ascii 1.0\nelement vertex some\nend_header\n", {"'some'"});
  refuses_ply("ply\nformat ascii 1.0\nelement face 0\nproperty list uchar int i\nend_header\n", {"first element"});
  refuses_ply("ply\nelement vertex 0\nproperty float x\nend_header\n", {"no format"});
}

TEST_F(LoadPoints, APlyThatClaimsMoreVerticesThanMemoryIsRefused) {
  std::string header = ply_header("ascii", "float", 1) + "1 2 3 0.5\n";
  header.replace(header.find("vertex 1"), 8, "vertex 9000000000000000000");
  refuses_ply(header, {"vertex 2 of 9000000000000000000"});
}

/// Points of one voxel size with damage, and with times if asked for.
openvdb::points::PointDataGrid::Ptr point_grid(const std::vector<openvdb::Vec3d>& positions,
                                               const std::vector<float>& damage, bool timed) {
  using namespace openvdb;
  initialize();
  const auto transform = math::Transform::createLinearTransform(0.25);
  const points::PointAttributeVector<Vec3d> wrapper(positions);
  const auto indices = tools::createPointIndexGrid<tools::PointIndexGrid>(wrapper, *transform);
  auto grid = points::createPointDataGrid<points::NullCodec, points::PointDataGrid>(*indices, wrapper, *transform);
  const auto attach = [&](const char* name, const std::vector<float>& values) {
    points::appendAttribute<float>(grid->tree(), name);
    points::populateAttribute<points::PointDataTree, tools::PointIndexTree, points::PointAttributeVector<float>>(
        grid->tree(), indices->tree(), name, points::PointAttributeVector<float>(values));
  };
  if (!damage.empty()) attach("damage", damage);
  if (timed) attach("damage_time", damage);
  grid->setName("points");
  return grid;
}

openvdb::FloatGrid::Ptr float_grid(const std::string& name, float value) {
  openvdb::initialize();
  const auto grid = openvdb::FloatGrid::create();
  grid->setTransform(openvdb::math::Transform::createLinearTransform(0.5));
  grid->setName(name);
  grid->tree().setValue({0, 0, 0}, value);
  grid->tree().setValue({2, -4, 20}, 0.0f);
  return grid;
}

fs::path write_vdb(const fs::path& path, const openvdb::GridCPtrVec& grids) {
  openvdb::io::File(path.string()).write(grids);
  return path;
}

TEST_F(LoadPoints, VdbPoints) {
  // Far apart: several leaves.
  const std::vector<openvdb::Vec3d> positions = {{0.1, 0.2, 0.3}, {5.05, -3.1, 7.7}, {0.12, 0.21, 0.3}};
  const std::vector<float> damage = {0.25f, 1.0f, 0.5f};
  for (const bool timed : {false, true}) {
    const DamagedPoints cloud = load_points(write_vdb(folder_ / "c.vdb", {point_grid(positions, damage, timed)}));
    ASSERT_EQ(cloud.points.size(), 3u);
    ASSERT_EQ(cloud.damage_time.size(), timed ? 3u : 0u);
    for (std::size_t i = 0; i < 3; ++i) {  // in any order
      const auto found = std::find(cloud.damage.begin(), cloud.damage.end(), double{damage[i]});
      ASSERT_NE(found, cloud.damage.end());
      const std::size_t at = static_cast<std::size_t>(found - cloud.damage.begin());
      const Vec3 expected(positions[i].x(), positions[i].y(), positions[i].z());
      EXPECT_LE((cloud.points[at] - expected).norm(), kQuantized);
      if (timed) {
        EXPECT_EQ(cloud.damage_time[at], double{damage[i]});
      }
    }
  }
}

TEST_F(LoadPoints, VdbVoxelsArePointsAtTheirCentres) {
  const DamagedPoints cloud = load_points(write_vdb(folder_ / "c.vdb", {float_grid("density", 1)}));
  ASSERT_EQ(cloud.points.size(), 2u);
  const std::size_t whole = cloud.damage[0] > 0 ? 0 : 1;
  EXPECT_EQ(cloud.points[whole], Vec3(0, 0, 0));
  EXPECT_EQ(cloud.points[1 - whole], Vec3(1, -2, 10));
}

TEST_F(LoadPoints, VdbTilesAreAllTheirVoxels) {
  const auto grid = float_grid("damage", 1);
  grid->tree().addTile(1, {64, 64, 64}, 0.5f, true);  // 8^3 voxels
  EXPECT_EQ(load_points(write_vdb(folder_ / "c.vdb", {grid})).points.size(), 2u + 512u);
}

TEST_F(LoadPoints, VdbTakesPointsBeforeTheGridCalledDamageBeforeAnyOther) {
  const auto points = point_grid({{1, 1, 1}}, {0.75f}, false);
  const auto damage = float_grid("damage", 1), other = float_grid("a_density", 0.5f);
  const DamagedPoints first = load_points(write_vdb(folder_ / "a.vdb", {damage, other, points}));
  EXPECT_EQ(first.damage, std::vector<double>{0.75});
  const DamagedPoints second = load_points(write_vdb(folder_ / "b.vdb", {other, damage}));
  EXPECT_EQ(*std::max_element(second.damage.begin(), second.damage.end()), 1);
}

TEST_F(LoadPoints, VdbThatIsWrongIsNamed) {
  const auto refuses = [&](const openvdb::GridCPtrVec& grids, const std::vector<std::string>& parts) {
    expect_error(write_vdb(folder_ / "wrong.vdb", grids), ErrorKind::usage, parts);
  };
  refuses({float_grid("a", 1), float_grid("b", 1)}, {"several float grids", "'damage'"});
  refuses({openvdb::Vec3SGrid::create()}, {"no point grid and no float grid"});
  refuses({openvdb::FloatGrid::create()}, {"no points"});
  refuses({point_grid({{1, 1, 1}}, {}, false)}, {"no attribute 'damage'"});
  refuses({float_grid("damage", 1.5f)}, {"between 0 and 1"});
  expect_error(file("torn.vdb", "not a VDB file"), ErrorKind::io, {});
  expect_error(file("empty.vdb", ""), ErrorKind::io, {});
}

}  // namespace
}  // namespace sunder::geometry
