#pragma once
/// TriangleMesh <-> OpenVDB level sets. For .cpp files of this module only.
#include <openvdb/openvdb.h>

#include "geometry/mesh.h"

namespace sunder::geometry::detail {

constexpr float half_band = 3;  ///< half width of narrow bands in voxels

/// Has to come before anything else of OpenVDB; any number of times.
void initialize_openvdb();

/// Where the voxels of a grid lie.
struct Voxels {
  Vec3 origin;  ///< centre of voxel (0, 0, 0) [m]
  double size;  ///< [m]
};

/// Distance to a closed mesh, negative inside, in a band of half_band voxels on either side; in units of which a voxel
/// has `voxel_length`. With `nearest`, also which face is nearest. Takes the corners as floats of voxels: 1e-4 voxels
/// off, a thousand voxels from the origin.
openvdb::FloatGrid::Ptr signed_distance(const TriangleMesh& mesh, const Voxels& voxels, double voxel_length = 1,
                                        openvdb::Int32Grid* nearest = nullptr);

/// The same in voxels and without a sign, of a mesh that need not be closed.
openvdb::FloatGrid::Ptr unsigned_distance(const TriangleMesh& mesh, const Voxels& voxels);

/// The zero surface of a level set (dual contouring on a uniform grid), faces outward.
TriangleMesh surface_of(const openvdb::FloatGrid& grid, const Voxels& voxels);

}  // namespace sunder::geometry::detail
