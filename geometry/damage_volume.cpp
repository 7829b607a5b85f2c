#include "geometry/damage_volume.h"

#include <array>
#include <cmath>
#include <sstream>

#include <openvdb/io/Stream.h>
#include <openvdb/openvdb.h>

#include "core/error.h"
#include "geometry/detail/vdb_mesh.h"

namespace sunder::geometry {
namespace {

using openvdb::FloatGrid;

// Weights of the three voxels around a coordinate and the first of them.
struct Weights {
  int first = 0;
  std::array<float, 3> weight{};
};

Weights spline_weights(double x) {
  const int centre = static_cast<int>(std::floor(x + 0.5));
  const double d = x - centre;
  return {centre - 1,
          {static_cast<float>(0.5 * (0.5 - d) * (0.5 - d)), static_cast<float>(0.75 - d * d),
           static_cast<float>(0.5 * (0.5 + d) * (0.5 + d))}};
}

// Sums of weighted values; after `divide` their means.
class WeightedMean {
 public:
  WeightedMean() : sum_(FloatGrid::create(0)), weight_(FloatGrid::create(0)) {}

  void add(const Vec3& index, double value) {
    const Weights x = spline_weights(index.x()), y = spline_weights(index.y()), z = spline_weights(index.z());
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j)
        for (int k = 0; k < 3; ++k) {
          const openvdb::Coord at(x.first + i, y.first + j, z.first + k);
          const float weight = x.weight[i] * y.weight[j] * z.weight[k];
          weight_.setValue(at, weight_.getValue(at) + weight);
          sum_.setValue(at, sum_.getValue(at) + weight * static_cast<float>(value));
        }
  }

  // Where the body is, the means; elsewhere `background`.
  FloatGrid::Ptr mean_inside(const FloatGrid& surface, double voxel, float background) {
    const float reach = static_cast<float>(voxel / 2);
    const FloatGrid::Ptr result = FloatGrid::create(background);
    auto out = result->getAccessor();
    auto distance = surface.getConstAccessor();
    for (auto weight = weight_.tree().cbeginValueOn(); weight; ++weight) {
      const openvdb::Coord at = weight.getCoord();
      if (*weight > 0 && distance.getValue(at) <= reach) out.setValue(at, sum_.getValue(at) / *weight);
    }
    return result;
  }

 private:
  struct Grid {
    explicit Grid(FloatGrid::Ptr made) : grid(std::move(made)), accessor(grid->getAccessor()) {}
    float getValue(const openvdb::Coord& at) { return accessor.getValue(at); }
    void setValue(const openvdb::Coord& at, float value) { accessor.setValue(at, value); }
    const openvdb::FloatTree& tree() const { return grid->tree(); }
    FloatGrid::Ptr grid;
    FloatGrid::Accessor accessor;
  };
  Grid sum_, weight_;
};

// From voxel indices to the world; OpenVDB multiplies rows from the left.
openvdb::math::Transform::Ptr placed(const Vec3& origin, double spacing, const Pose& pose) {
  const Mat3 turned = pose.orientation.toRotationMatrix() * spacing;
  const Vec3 offset = pose * origin;
  openvdb::Mat4R matrix = openvdb::Mat4R::identity();
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) matrix(row, column) = turned(column, row);
    matrix(3, row) = offset[row];
  }
  return openvdb::math::Transform::createLinearTransform(matrix);
}

void finish(FloatGrid& grid, const char* name, openvdb::GridClass kind,
            const openvdb::math::Transform::Ptr& transform) {
  grid.setName(name);
  grid.setGridClass(kind);
  grid.setTransform(transform);
  grid.pruneGrid();
}

// OpenVDB writes a random identifier into the header, after magic number, three versions and a flag; the same input has
// to give the same bytes.
void fix_identifier(std::string& bytes) {
  constexpr std::size_t kAt = 8 + 3 * 4 + 1;
  const std::string fixed = "00000000-0000-4000-8000-000000000000";
  if (bytes.size() < kAt + fixed.size() || bytes[kAt + 8] != '-' || bytes[kAt + 23] != '-')
    throw Error(ErrorKind::internal, "OpenVDB's file header is not as expected");
  bytes.replace(kAt, fixed.size(), fixed);
}

}  // namespace

std::string damage_volume(const TriangleMesh& solid, const DamageSamples& samples, const Pose& pose) {
  const std::size_t count = samples.points.size();
  if (samples.damage.size() != count || samples.damage_time.size() != count || !(samples.spacing > 0))
    throw Error(ErrorKind::usage, "a damage volume needs damage and damage time for each point, and their spacing");
  const Vec3 origin = bounds(solid).min();
  const FloatGrid::Ptr surface = detail::signed_distance(solid, {origin, samples.spacing}, samples.spacing);
  WeightedMean damage, damage_time;
  for (std::size_t p = 0; p < count; ++p) {
    const Vec3 index = (samples.points[p] - origin) / samples.spacing;
    damage.add(index, samples.damage[p]);
    if (samples.damage_time[p] >= 0) damage_time.add(index, samples.damage_time[p]);
  }
  const auto transform = placed(origin, samples.spacing, pose);
  const FloatGrid::Ptr fog = damage.mean_inside(*surface, samples.spacing, 0);
  const FloatGrid::Ptr time = damage_time.mean_inside(*surface, samples.spacing, -1);
  finish(*surface, "surface", openvdb::GRID_LEVEL_SET, transform);
  finish(*fog, "damage", openvdb::GRID_FOG_VOLUME, transform);
  finish(*time, "damage_time", openvdb::GRID_UNKNOWN, transform);
  const openvdb::GridCPtrVec grids = {surface, fog, time};
  std::ostringstream bytes(std::ios::binary);
  openvdb::io::Stream(bytes).write(grids);
  std::string file = std::move(bytes).str();
  fix_identifier(file);
  return file;
}

}  // namespace sunder::geometry
