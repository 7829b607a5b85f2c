#pragma once
/// What a medial face is: does damage lie between its two sites, and since when?
#include "crack/detail/lattice.h"

namespace sunder::crack::detail {

/// Does damage fill the whole segment between two sites, but for half a spacing at either end where the sites stand?
/// Trilinear in the raster; what is outside the body is not damaged.
bool damage_between(const Raster& raster, const Vec3& a, const Vec3& b, double crack_damage);

/// Mean of the nodes around that know theirs; -1 if none does.
double damage_time_at(const Raster& raster, const Vec3& x);

/// Does a way of at most three links over sound nodes join two nodes? Then they are neighbours on a rough side of a
/// crack; sites of one piece that none joins lie on its two sides.
bool on_one_side(const Raster& raster, int node_a, int node_b, double crack_damage);

}  // namespace sunder::crack::detail
