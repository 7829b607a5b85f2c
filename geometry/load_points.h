#pragma once
/// Clouds of damaged points, as any solver may write them.
#include <filesystem>
#include <vector>

#include "core/types.h"

namespace sunder::geometry {

struct DamagedPoints {
  std::vector<Vec3> points;         ///< [m]
  std::vector<double> damage;       ///< in [0, 1]
  std::vector<double> damage_time;  ///< when damage reached 1 [s], negative: never; empty when the file has none
};

/// Reads by extension:
/// - .ply: ASCII or binary little-endian; vertex properties x, y, z, damage and, if there, damage_time;
/// - .vdb: the first point grid (attributes P, damage and, if there, damage_time, as float or double), or else the
///   first float grid of the name "damage", or the only float grid: a point for the centre of every active voxel;
/// - anything else: text, `x y z damage [damage_time]` a line, separated by blanks, tabs, commas or semicolons; lines
///   that are empty or start with # are skipped, and so is a first line that names columns.
/// Damage is clamped to [0, 1] when it is within 1e-6 of it. Errors: ErrorKind::io when the file cannot be read,
/// ErrorKind::usage (file, line or point, what is wrong) when it holds no points, misses a column or property, or a
/// number is not finite or damage is outside [0, 1].
DamagedPoints load_points(const std::filesystem::path& file);

}  // namespace sunder::geometry
