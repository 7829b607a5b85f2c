#pragma once
/// Fragments from a labelled arrangement.
#include "geometry/cut.h"
#include "geometry/detail/labels.h"

namespace sunder::geometry::detail {

/// A crack ends inside the body, or the regions around one of its edges there contradict each other.
bool cracks_end_inside(const Arrangement& arrangement, const Wedges& wedges, const std::vector<char>& is_inside);

/// Fragments as `cut` delivers them; a body that nothing touches is returned as it is. Where a region touches itself
/// along an edge or at a vertex the fragment has a vertex per fan of faces. Errors: ErrorKind::mesh when a void has no
/// shell around it.
std::vector<Fragment> assemble(const TriangleMesh& body, const Arrangement& arrangement, const CrackComplex& complex,
                               const Wedges& wedges, Labels& labels);

}  // namespace sunder::geometry::detail
