#pragma once
/// Point clouds of bodies with prescribed damage: set-ups of the catalogue and of the tests of `crack`.
#include <cstdint>
#include <functional>

#include "core/random.h"
#include "crack/extract.h"

namespace sunder::crack::setup {

using Inside = std::function<bool(const Vec3&)>;

/// Points at the cell centres of a lattice over `box` that lie in the body, each displaced by up to `jitter` spacings
/// along each axis.
inline DamageField cloud(const Box& box, double spacing, const Inside& body, const Inside& damaged, double jitter = 0,
                         std::uint64_t seed = 1) {
  DamageField field;
  field.spacing = spacing;
  field.cell_size = 2 * spacing;
  const Eigen::Vector3i n = (box.sizes() / spacing).array().round().cast<int>();
  std::uint64_t number = 0;
  for (int k = 0; k < n.z(); ++k)
    for (int j = 0; j < n.y(); ++j)
      for (int i = 0; i < n.x(); ++i) {
        Vec3 x = box.min() + spacing * Vec3(i + 0.5, j + 0.5, k + 0.5);
        if (!body(x)) continue;
        for (int axis = 0; axis < 3; ++axis) x[axis] += jitter * spacing * (2 * random_unit(seed, axis, number) - 1);
        ++number;
        field.points.push_back(x);
        field.damage.push_back(damaged(x) ? 1.0 : 0.0);
      }
  return field;
}

inline bool everywhere(const Vec3&) { return true; }
inline bool nowhere(const Vec3&) { return false; }

inline Box unit_cube() { return {Vec3::Zero(), Vec3::Ones()}; }

}  // namespace sunder::crack::setup
