/// Damage as voxels, read back by OpenVDB.
#include "geometry/damage_volume.h"

#include <filesystem>
#include <fstream>
#include <map>
#include <numbers>

#include <gtest/gtest.h>
#include <openvdb/io/File.h>
#include <openvdb/openvdb.h>

#include "core/error.h"
#include "geometry/primitives.h"
#include "geometry/sample.h"

namespace sunder::geometry {
namespace {

constexpr double kRadius = 0.1;
constexpr double kRounding = 1e-5;  // of sums of some hundred terms in single precision, of numbers below 10

struct Case {
  TriangleMesh solid = sphere(kRadius);
  Samples samples;
  std::vector<double> damage, time;
  Pose pose{Vec3(0.3, -0.2, 1.5), Quat(Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()))};

  Case() {
    SilentProgress progress;
    samples = sample_solid(solid, {.count = 20000}, progress);
    for (const Vec3& x : samples.points) {
      damage.push_back(x.x() > 0 ? 1 : 0);
      time.push_back(x.x() > 0 ? 2.5 : -1);
    }
  }
  std::string bytes() const { return damage_volume(solid, {samples.points, damage, time, samples.spacing}, pose); }
};

// As other programs read it: from a file that can be read in parts.
std::map<std::string, openvdb::FloatGrid::Ptr> read_back(const std::string& bytes) {
  const auto path = std::filesystem::path(testing::TempDir()) / ("damage_volume_" + std::to_string(getpid()) + ".vdb");
  std::ofstream(path, std::ios::binary) << bytes;
  openvdb::initialize();
  openvdb::io::File file(path.string());
  file.open();
  std::map<std::string, openvdb::FloatGrid::Ptr> grids;
  for (auto name = file.beginName(); name != file.endName(); ++name)
    grids[*name] = openvdb::gridPtrCast<openvdb::FloatGrid>(file.readGrid(*name));
  file.close();
  std::filesystem::remove(path);
  return grids;
}

float value_at(const openvdb::FloatGrid& grid, const Vec3& world) {
  const openvdb::Vec3d at = grid.transform().worldToIndex({world.x(), world.y(), world.z()});
  return grid.getConstAccessor().getValue(openvdb::Coord::round(at));
}

TEST(DamageVolume, HoldsTheBodyWhereItIs) {
  const Case c;
  const auto grids = read_back(c.bytes());
  ASSERT_EQ(grids.size(), 3u);
  const openvdb::FloatGrid& surface = *grids.at("surface");
  EXPECT_EQ(surface.getGridClass(), openvdb::GRID_LEVEL_SET);
  EXPECT_NEAR(surface.voxelSize().x(), c.samples.spacing, 1e-12);
  EXPECT_LT(value_at(surface, c.pose.position), 0);
  int band = 0;
  for (auto voxel = surface.cbeginValueOn(); voxel; ++voxel, ++band) {
    const openvdb::Vec3d world = surface.indexToWorld(voxel.getCoord());
    const double distance = (Vec3(world.x(), world.y(), world.z()) - c.pose.position).norm() - kRadius;
    // The triangles lie inside the sphere by at most the sagitta of its facets, well under a tenth of a voxel here.
    EXPECT_NEAR(*voxel, distance, 0.1 * c.samples.spacing);
  }
  EXPECT_GT(band, 1000);
}

TEST(DamageVolume, KeepsDamageAndItsTimeInTheBodysFrame) {
  const Case c;
  const auto grids = read_back(c.bytes());
  const openvdb::FloatGrid &damage = *grids.at("damage"), &time = *grids.at("damage_time");
  EXPECT_EQ(damage.getGridClass(), openvdb::GRID_FOG_VOLUME);
  for (const Vec3& x : c.samples.points) {
    const bool deep = x.norm() < kRadius - 2 * c.samples.spacing;
    if (!deep || std::abs(x.x()) < 3 * c.samples.spacing) continue;  // beyond the reach of the other half's points
    EXPECT_NEAR(value_at(damage, c.pose * x), x.x() > 0 ? 1 : 0, kRounding);
    EXPECT_NEAR(value_at(time, c.pose * x), x.x() > 0 ? 2.5 : -1, kRounding);
  }
  const double volume = static_cast<double>(damage.activeVoxelCount()) * std::pow(c.samples.spacing, 3);
  const double ball = 4 * std::numbers::pi / 3 * std::pow(kRadius + c.samples.spacing / 2, 3);
  EXPECT_NEAR(volume / ball, 1, 0.05) << "all of the body's voxels are active, and none beyond half a voxel outside";
  EXPECT_NEAR(static_cast<double>(time.activeVoxelCount()) / static_cast<double>(damage.activeVoxelCount()), 0.5, 0.1);
}

TEST(DamageVolume, TheSameInputGivesTheSameBytes) {
  const Case c;
  EXPECT_EQ(c.bytes(), c.bytes());
}

TEST(DamageVolume, RefusesListsThatDoNotFit) {
  Case c;
  c.time.pop_back();
  EXPECT_THROW(c.bytes(), Error);
}

}  // namespace
}  // namespace sunder::geometry
