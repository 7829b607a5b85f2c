#pragma once
/// Points of a continuum one by one, and blocks of its grid by name.
#include <array>

#include "mpm/continuum.h"

namespace sunder::mpm {

struct Lane {
  std::size_t chunk;
  int lane;
};

inline Lane lane_of(int slot) { return {static_cast<std::size_t>(slot / chunk_size), slot % chunk_size}; }

inline void read(const double (*from)[chunk_size], int lane, Vec3& to) {
  for (int a = 0; a < 3; ++a) to[a] = from[a][lane];
}

inline void read(const double (*from)[chunk_size], int lane, Mat3& to) {
  for (int k = 0; k < 9; ++k) to(k / 3, k % 3) = from[k][lane];
}

inline void write(const Vec3& from, int lane, double (*to)[chunk_size]) {
  for (int a = 0; a < 3; ++a) to[a][lane] = from[a];
}

inline void write(const Mat3& from, int lane, double (*to)[chunk_size]) {
  for (int k = 0; k < 9; ++k) to[k][lane] = from(k / 3, k % 3);
}

inline PointState read(const PointChunk& c, int lane) {
  PointState p;
  read(c.material_position, lane, p.material_position);
  read(c.displacement, lane, p.displacement);
  read(c.displacement_gradient, lane, p.displacement_gradient);
  p.threshold = c.threshold[lane];
  p.strength = c.strength[lane];
  p.softening_slope = c.softening_slope[lane];
  p.damage = c.damage[lane];
  p.damage_time = c.damage_time[lane];
  p.dissipated = c.dissipated[lane];
  return p;
}

inline void write(const PointState& p, int id, int lane, PointChunk& c) {
  write(p.material_position, lane, c.material_position);
  write(p.displacement, lane, c.displacement);
  write(p.displacement_gradient, lane, c.displacement_gradient);
  c.threshold[lane] = p.threshold;
  c.strength[lane] = p.strength;
  c.softening_slope[lane] = p.softening_slope;
  c.damage[lane] = p.damage;
  c.damage_time[lane] = p.damage_time;
  c.dissipated[lane] = p.dissipated;
  c.side[lane] = 0;
  c.side_corner[lane] = -1;
  c.id[lane] = id;
}

inline PointChunk empty_chunk() {
  PointChunk chunk;
  for (int lane = 0; lane < chunk_size; ++lane) write(PointState{}, -1, lane, chunk);
  return chunk;
}

inline int floor_div(int a, int b) { return a >= 0 ? a / b : -((b - 1 - a) / b); }

inline std::array<int, 3> plus(const std::array<int, 3>& a, int x, int y, int z) {
  return {a[0] + x, a[1] + y, a[2] + z};
}

}  // namespace sunder::mpm
