#pragma once
/// Where two convex parts, or a part and the ground, touch or are about to.
#include <vector>

#include "core/types.h"
#include "rigid/detail/hull.h"

namespace sunder::rigid::detail {

struct Contact {
  Vec3 on_a = Vec3::Zero(), on_b = Vec3::Zero();  ///< world [m]; they differ by distance * normal
  Vec3 normal = Vec3::Zero();                     ///< unit, from b towards a
  double distance = 0;                            ///< negative in overlap [m]
};

/// At most four points, the deepest first. Empty if the parts are further than `reach` apart. All points lie within a
/// small band above the deepest, so that far corners of a tilted part do not crowd out the touching ones.
std::vector<Contact> contacts(const Hull& a, const btTransform& place_a, const Hull& b, const btTransform& place_b,
                              double reach);
std::vector<Contact> contacts_with_plane(const Hull& a, const btTransform& place_a, double height, double reach);

}  // namespace sunder::rigid::detail
