#include "geometry/detail/vdb_points.h"

#include <functional>

#include <openvdb/io/File.h>
#include <openvdb/openvdb.h>
#include <openvdb/points/AttributeArray.h>
#include <openvdb/points/PointDataGrid.h>

#include "core/error.h"
#include "geometry/detail/vdb_mesh.h"

namespace sunder::geometry::detail {

namespace {

using openvdb::points::PointDataGrid;
using Leaf = openvdb::points::PointDataTree::LeafNodeType;

[[noreturn]] void refuse(const std::filesystem::path& file, const std::string& what) {
  throw Error(ErrorKind::usage, file.string() + ": " + what);
}

Vec3 to_vec3(const openvdb::Vec3d& x) { return {x.x(), x.y(), x.z()}; }

openvdb::GridPtrVec read_grids(const std::filesystem::path& file) {
  initialize_openvdb();
  try {
    openvdb::io::File in(file.string());
    in.open();
    const openvdb::GridPtrVecPtr grids = in.getGrids();
    return *grids;
  } catch (const openvdb::Exception& error) {
    throw Error(ErrorKind::io, "cannot read " + file.string() + ": " + error.what());
  }
}

/// Reads a scalar attribute of one leaf.
using Scalar = std::function<double(openvdb::Index)>;

Scalar scalar_attribute(const Leaf& leaf, const std::string& name, const std::filesystem::path& file) {
  const openvdb::points::AttributeArray& array = leaf.constAttributeArray(name);
  if (array.hasValueType<float>())
    return
        [handle = openvdb::points::AttributeHandle<float>(array)](openvdb::Index i) { return double{handle.get(i)}; };
  if (array.hasValueType<double>())
    return [handle = openvdb::points::AttributeHandle<double>(array)](openvdb::Index i) { return handle.get(i); };
  refuse(file, "the point attribute '" + name + "' is neither float nor double");
}

DamagedPoints points_of(const PointDataGrid& grid, const std::filesystem::path& file) {
  DamagedPoints cloud;
  for (auto leaf = grid.tree().cbeginLeaf(); leaf; ++leaf) {
    const auto has = [&](const char* name) {
      return leaf->attributeSet().find(name) != openvdb::points::AttributeSet::INVALID_POS;
    };
    if (!has("P") || !has("damage")) refuse(file, "its points have no attribute 'damage'");
    const openvdb::points::AttributeHandle<openvdb::Vec3f> position(leaf->constAttributeArray("P"));
    const Scalar damage = scalar_attribute(*leaf, "damage", file);
    const bool timed = has("damage_time");
    const Scalar time = timed ? scalar_attribute(*leaf, "damage_time", file) : Scalar();
    for (auto index = leaf->beginIndexOn(); index; ++index) {
      const openvdb::Vec3d at = openvdb::Vec3d(position.get(*index)) + index.getCoord().asVec3d();
      cloud.points.push_back(to_vec3(grid.transform().indexToWorld(at)));
      cloud.damage.push_back(damage(*index));
      if (timed) cloud.damage_time.push_back(time(*index));
    }
  }
  return cloud;
}

DamagedPoints voxels_of(const openvdb::FloatGrid& grid) {
  DamagedPoints cloud;
  for (auto voxel = grid.cbeginValueOn(); voxel; ++voxel) {
    openvdb::CoordBBox box;  // one voxel, or a tile of them
    voxel.getBoundingBox(box);
    for (auto at = box.begin(); at; ++at) {
      cloud.points.push_back(to_vec3(grid.transform().indexToWorld((*at).asVec3d())));
      cloud.damage.push_back(voxel.getValue());
    }
  }
  return cloud;
}

}  // namespace

DamagedPoints load_vdb_points(const std::filesystem::path& file) {
  const openvdb::GridPtrVec grids = read_grids(file);
  std::vector<openvdb::FloatGrid::Ptr> floats;
  for (const openvdb::GridBase::Ptr& grid : grids) {
    if (const auto points = openvdb::gridPtrCast<PointDataGrid>(grid)) return points_of(*points, file);
    if (const auto values = openvdb::gridPtrCast<openvdb::FloatGrid>(grid)) floats.push_back(values);
  }
  for (const openvdb::FloatGrid::Ptr& values : floats)
    if (values->getName() == "damage") return voxels_of(*values);
  if (floats.size() == 1) return voxels_of(*floats.front());
  refuse(file, floats.empty() ? "it holds no point grid and no float grid"
                              : "it holds several float grids and none is called 'damage'");
}

}  // namespace sunder::geometry::detail
