#pragma once
/// The faces between regions as triangles, and how they follow each other around their edges.
#include <vector>

#include "geometry/cut.h"
#include "geometry/detail/edges.h"

namespace sunder::geometry::detail {

/// One of the two faces of a crack triangle: side 0 bounds the region `inside`, side 1 the region `outside`.
struct CrackSide {
  int triangle, side;
  bool operator==(const CrackSide&) const = default;
};

struct CrackComplex {
  struct Owner {
    int face;  // of the RegionBoundary
    int inside, outside;
  };
  std::vector<Vec3> vertices;
  std::vector<Triangle> triangles;  // counter-clockwise seen from `outside`
  std::vector<Owner> owner;         // per triangle
  int region(const CrackSide& at) const {
    return at.side == 0 ? owner[at.triangle].inside : owner[at.triangle].outside;
  }
};

/// Hull faces and faces between a region and itself are left out. Every polygon is triangulated once, so that the
/// flattest triangle is as high as can be. Errors: ErrorKind::mesh for what is no region boundary.
CrackComplex crack_complex(const RegionBoundary& regions);

/// The triangles whose boxes meet the given one, over the same vertices.
CrackComplex part_near(const CrackComplex& complex, const Box& box);

/// The wedges of space around the edges. A wedge lies between two sides of triangles.
class Wedges {
 public:
  Wedges(const CrackComplex& complex, const Edges& edges);

  /// The triangles around the edge do not part space into regions: the crack ends there, or regions contradict.
  bool is_loose(int edge) const { return loose_[edge]; }

  /// The half-edges at an edge, counter-clockwise about its direction: outer sides of forward triangles bound the wedge
  /// after them.
  const HalfEdge* begin(int edge) const { return ring_.data() + edges_.first[edge]; }
  const HalfEdge* end(int edge) const { return ring_.data() + edges_.first[edge + 1]; }

  /// The side across the wedge that this side bounds at corner k of its triangle. The edge must not be loose.
  CrackSide across(const CrackSide& at, int corner) const;

  /// A region lies in several wedges of the edge.
  bool repeats_region(int edge) const { return repeats_[edge]; }

 private:
  bool sort_around(int edge);
  bool hand_over(int edge) const;

  const CrackComplex& complex_;
  const Edges& edges_;
  std::vector<HalfEdge> ring_;  // the half-edges of every edge, counter-clockwise about its direction
  std::vector<bool> loose_, repeats_;
};

}  // namespace sunder::geometry::detail
