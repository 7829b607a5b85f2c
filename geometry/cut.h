#pragma once
/// Cutting a solid into closed fragments along region boundaries.
#include <string>
#include <vector>

#include "core/progress.h"
#include "geometry/mesh.h"

namespace sunder::geometry {

/// Faces between regions. They share vertices by index, so around every edge inside the body the regions follow each
/// other; faces may be bent and regions need not be convex. What lies beyond the body does not matter.
struct RegionBoundary {
  struct Face {
    std::vector<int> loop;  ///< vertex indices of a triangle or a planar convex polygon, counter-clockwise seen from
                            ///< `outside`: the normal points from inside to outside
    int inside = 0;         ///< region on the inner side
    int outside = -1;       ///< region on the outer side; -1: a face of the hull, which is ignored
  };
  std::vector<Vec3> vertices;
  std::vector<Face> faces;
  int region_count = 0;
};

/// One closed piece. Its faces know where they come from and what lies beyond them.
struct Fragment {
  TriangleMesh mesh;
  std::vector<int> source_face;  ///< per face: the face of the body that it is a part of, or -1 for a face on a crack
  int region = 0;
  std::vector<int> crack_face;  ///< per face: index into RegionBoundary::faces, -1 for a part of the body's surface
  std::vector<int> neighbour;   ///< per face: the fragment that has the same face turned round, -1 outside
  /// Per vertex: number of its point. Points of all fragments are numbered together, so the same number in two
  /// fragments means the same position, bit for bit, and different numbers mean different positions.
  std::vector<int> vertex_id;
};

enum class CutStatus {
  ok,
  bad_input,    ///< the body is not a solid, or the regions contradict each other or end inside the body
  failed,       ///< no attempt gave closed fragments without self-intersection
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
  double volume_tolerance = 1e-12;  ///< largest accepted volume_error
};

/// Divides the body along all faces between regions in one pass: an arrangement with exact predicates, whose points are
/// computed and rounded once, from the input alone. Fragments are the connected solids of every region, so a region may
/// give no, one or several; a shell that lies inside another shell of the same region is a void of that fragment.
/// Neighbours share their faces bit for bit. A body that nothing divides comes back as it is. What is delivered is
/// closed, two-manifold and free of self-intersections; when a crack only touches a face, an edge or a vertex of the
/// body, or rounding would break a fragment, all regions are moved together by `nudges` and the cut is made again.
/// Where a region touches itself along an edge or at a vertex, each fan of faces has a vertex of its own there: the
/// fragment is a two-manifold with coincident vertices. Such a fragment may be cut again: its coincident vertices are
/// moved apart by about 1e-9 of its size first, and the fragments are those of the body that it becomes. Fragments are
/// ordered by region, then by their lowest vertex. The result does not depend on the number of threads.
CutResult cut(const TriangleMesh& body, const RegionBoundary& regions, const CutSettings& settings, Progress& progress);

}  // namespace sunder::geometry
