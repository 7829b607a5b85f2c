#pragma once
/// Cutting a solid into closed fragments along region boundaries.
#include <string>
#include <vector>

#include "core/progress.h"
#include "geometry/mesh.h"

namespace sunder::geometry {

/// Space divided into regions by planar convex polygons that share vertices by index. Every region's faces together are
/// a closed surface (a union of convex cells); the regions fill a box that holds the body with room to spare.
struct RegionBoundary {
  struct Face {
    std::vector<int>
        loop;  ///< vertex indices, counter-clockwise seen from `outside`: the normal points from inside to outside
    int inside = 0;    ///< region on the inner side
    int outside = -1;  ///< region on the outer side, -1: the hull of the complex
  };
  std::vector<Vec3> vertices;
  std::vector<Face> faces;
  int region_count = 0;
};

/// One closed piece. Faces cut out of the body know where they come from.
struct Fragment {
  TriangleMesh mesh;
  std::vector<int> source_face;  ///< per face: the face of the body that it is a part of, or -1 for a face on a crack
  int region = 0;
};

enum class CutStatus {
  ok,
  bad_input,    ///< the body is not a solid, or a region's faces are not a closed surface
  failed,       ///< a Boolean operation failed, or a fragment came out open or self-intersecting
  volume_lost,  ///< the fragments' volumes do not add up to the body's
};

struct CutResult {
  CutStatus status = CutStatus::ok;
  std::string detail;               ///< what failed, for the log; empty when ok
  std::vector<Fragment> fragments;  ///< empty unless ok
  double volume_error = 0;          ///< |sum of fragment volumes - body volume| / body volume
  int nudges = 0;  ///< times the regions were moved together by 1e-6 of the body's size to get a valid cut
};

struct CutSettings {
  double volume_tolerance = 1e-6;  ///< largest accepted volume_error
};

/// Intersects the body with every region (CGAL corefinement with exact predicates) and splits the results into
/// connected solids, so a region may give no, one or several fragments. A region boundary may cross the body any number
/// of times and its faces may lie outside. The body is cut once: no fragment is ever cut again, so rounding does not
/// accumulate. Fragments are ordered by region, then by their smallest source vertex position: the same input gives the
/// same output. Void shells: a shell that lies inside another shell of the same region belongs to the same fragment.
CutResult cut(const TriangleMesh& body, const RegionBoundary& regions, const CutSettings& settings, Progress& progress);

}  // namespace sunder::geometry
