#pragma once
/// Vertices where a fragment touches itself.
#include "geometry/cut.h"
#include "geometry/detail/arrangement.h"
#include "geometry/detail/crack_complex.h"

namespace sunder::geometry::detail {

class PinchFinder {
 public:
  PinchFinder(const Arrangement& arrangement, const Wedges& wedges);

  /// Gives every fan of faces around a vertex a vertex of its own. Needs the faces and `vertex_id` of the fragment;
  /// `sides`: per face the side of the crack triangle that it is a part of (triangle -1: none).
  void split(Fragment& fragment, const std::vector<CrackSide>& sides) const;

 private:
  bool share_wedge(const CrackSide& a, const CrackSide& b) const;

  std::vector<bool> suspect_;  // per point
  const Wedges& wedges_;
};

}  // namespace sunder::geometry::detail
