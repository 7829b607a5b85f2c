#pragma once
/// Cracks that separate nothing, shown as thin gaps.
#include "crack/extract.h"

namespace sunder::crack {

struct Hairlines {
  int first_gap = 0;  ///< regions from this one on are gaps: what geometry::cut makes of them is empty space
  int gaps = 0;
  long faces = 0;     ///< partial crack faces that are shown
  long left_out = 0;  ///< and those that are not: beside a crack between regions, at branches, or thinner than the gap
};

/// Adds a region for the gap along every connected sheet of partial cracks: the sheet's two sides, `width` [m] apart in
/// the middle of its faces, closing to nothing at the sheet's border and where sheets meet. Gaps change nothing but the
/// regions that they lie in. `boundary` is that of the extraction, or empty when it separates nothing.
Hairlines add_hairlines(const Extraction& extraction, double width, geometry::RegionBoundary& boundary);

}  // namespace sunder::crack
