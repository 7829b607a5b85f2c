#include "crack/detail/grain.h"

#include "crack/detail/index_table.h"

namespace sunder::crack::detail {

namespace {

/// Value noise of one lattice with unit cells.
double octave(const Vec3& x, std::uint64_t seed, std::uint64_t stream) {
  const GridCell base = cell_of(x, 1);
  const Vec3 f = x - base.cast<double>();
  const Vec3 t = (f.array().square() * (3 - 2 * f.array())).matrix();
  double sum = 0;
  for (int corner = 0; corner < 8; ++corner) {
    const GridCell offset(corner & 1, corner >> 1 & 1, corner >> 2);
    double w = 1;
    for (int axis = 0; axis < 3; ++axis) w *= offset[axis] ? t[axis] : 1 - t[axis];
    sum += w * random_unit(seed, stream, cell_key(base + offset));
  }
  return sum;
}

}  // namespace

double grain_at(const Vec3& x, double size, std::uint64_t seed) {
  // Turned out of the axes, along which bodies like to break: 2/3, 2/3, 1/3 and its kin are an orthonormal frame.
  const Vec3 turned =
      Vec3(2 * x.x() - x.y() + 2 * x.z(), 2 * x.x() + 2 * x.y() - x.z(), -x.x() + 2 * x.y() + 2 * x.z()) / (3 * size);
  constexpr std::uint64_t stream = 0x6772'6169'6e00;
  return (2 * octave(turned, seed, stream) + octave(2 * turned, seed, stream + 1)) / 3;
}

}  // namespace sunder::crack::detail
