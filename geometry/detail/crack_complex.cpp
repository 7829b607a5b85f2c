#include "geometry/detail/crack_complex.h"

#include <algorithm>
#include <limits>
#include <string>

#include "core/error.h"
#include "geometry/detail/predicates.h"

namespace sunder::geometry::detail {
namespace {

[[noreturn]] void reject(const std::string& why) { throw Error(ErrorKind::mesh, why); }

Vec3 polygon_normal(const std::vector<Vec3>& vertices, const std::vector<int>& loop) {
  Vec3 normal = Vec3::Zero();
  for (std::size_t i = 1; i + 1 < loop.size(); ++i) {
    const Vec3& a = vertices[loop[0]];
    normal += (vertices[loop[i]] - a).cross(vertices[loop[i + 1]] - a);
  }
  return normal;
}

// The lowest height of the triangle; 0 if it has no area or turns the other way than the polygon.
double height(const std::vector<Vec3>& vertices, const Triangle& face, const Vec3& normal) {
  const Vec3 &a = vertices[face[0]], &b = vertices[face[1]], &c = vertices[face[2]];
  const Vec3 area = (b - a).cross(c - a);
  if (!(area.dot(normal) > 0) || collinear(a, b, c)) return 0;
  return area.norm() / std::sqrt(std::max({(b - a).squaredNorm(), (c - b).squaredNorm(), (a - c).squaredNorm()}));
}

/// The triangulation of a convex polygon whose flattest triangle is the highest, by dynamic programming over its
/// diagonals (Klincsek, "Minimal triangulations of polygonal domains", 1980, with another measure).
class Triangulator {
 public:
  Triangulator(const std::vector<Vec3>& vertices, const std::vector<int>& loop)
      : vertices_(vertices), loop_(loop), normal_(polygon_normal(vertices, loop)) {
    const int count = static_cast<int>(loop.size());
    best_.assign(count * count, std::numeric_limits<double>::infinity());
    apex_.assign(count * count, -1);
    for (int span = 2; span < count; ++span) {
      for (int i = 0; i + span < count; ++i) solve(i, i + span);
    }
  }

  double worst_height() const { return best_[at(0, static_cast<int>(loop_.size()) - 1)]; }

  void append_to(std::vector<Triangle>& result) const { append(0, static_cast<int>(loop_.size()) - 1, result); }

 private:
  int at(int i, int j) const { return i * static_cast<int>(loop_.size()) + j; }

  void solve(int i, int j) {
    best_[at(i, j)] = -1;
    for (int k = i + 1; k < j; ++k) {
      const double own = height(vertices_, {loop_[i], loop_[k], loop_[j]}, normal_);
      const double worst = std::min({own, best_[at(i, k)], best_[at(k, j)]});
      if (worst > best_[at(i, j)]) best_[at(i, j)] = worst, apex_[at(i, j)] = k;
    }
  }

  void append(int i, int j, std::vector<Triangle>& result) const {
    if (j < i + 2) return;
    const int k = apex_[at(i, j)];
    append(i, k, result);
    result.push_back({loop_[i], loop_[k], loop_[j]});
    append(k, j, result);
  }

  const std::vector<Vec3>& vertices_;
  const std::vector<int>& loop_;
  Vec3 normal_;
  std::vector<double> best_;
  std::vector<int> apex_;
};

void require_valid(const RegionBoundary& regions, const RegionBoundary::Face& face) {
  const int count = static_cast<int>(regions.vertices.size());
  const auto valid = [&](int vertex) { return vertex >= 0 && vertex < count; };
  if (!std::all_of(face.loop.begin(), face.loop.end(), valid)) reject("a region face has a missing vertex");
  if (face.inside < 0 || std::max(face.inside, face.outside) >= regions.region_count || face.outside < -1) {
    reject("a region face belongs to a region that does not exist");
  }
}

void require_distinct_points(const CrackComplex& complex) {
  std::vector<int> used;
  for (const Triangle& face : complex.triangles) used.insert(used.end(), face.begin(), face.end());
  std::sort(used.begin(), used.end());
  used.erase(std::unique(used.begin(), used.end()), used.end());
  const auto less = [&](int a, int b) {
    const Vec3 &x = complex.vertices[a], &y = complex.vertices[b];
    return std::lexicographical_compare(x.begin(), x.end(), y.begin(), y.end());
  };
  std::sort(used.begin(), used.end(), less);
  const auto equal = [&](int a, int b) { return complex.vertices[a] == complex.vertices[b]; };
  if (std::adjacent_find(used.begin(), used.end(), equal) != used.end()) reject("regions have coincident vertices");
}

void require_distinct_triangles(const CrackComplex& complex) {
  std::vector<Triangle> faces = complex.triangles;
  for (Triangle& face : faces) std::sort(face.begin(), face.end());
  std::sort(faces.begin(), faces.end());
  if (std::adjacent_find(faces.begin(), faces.end()) != faces.end()) reject("a region face occurs twice");
}

}  // namespace

CrackComplex crack_complex(const RegionBoundary& regions) {
  const auto finite = [](const Vec3& x) { return x.allFinite(); };
  if (!std::all_of(regions.vertices.begin(), regions.vertices.end(), finite)) {
    reject("a region has a vertex that is not finite");
  }
  CrackComplex complex{regions.vertices, {}, {}};
  for (std::size_t i = 0; i < regions.faces.size(); ++i) {
    const RegionBoundary::Face& face = regions.faces[i];
    require_valid(regions, face);
    if (face.outside < 0 || face.inside == face.outside) continue;
    if (face.loop.size() < 3) reject("a region face has less than three vertices");
    const Triangulator triangulator(complex.vertices, face.loop);
    if (!(triangulator.worst_height() > 0)) reject("a region face has no area or is not convex");
    triangulator.append_to(complex.triangles);
    complex.owner.resize(complex.triangles.size(), {static_cast<int>(i), face.inside, face.outside});
  }
  require_distinct_points(complex);
  require_distinct_triangles(complex);
  return complex;
}

CrackComplex part_near(const CrackComplex& complex, const Box& box) {
  CrackComplex part{complex.vertices, {}, {}};
  for (std::size_t i = 0; i < complex.triangles.size(); ++i) {
    Box own;
    for (const int vertex : complex.triangles[i]) own.extend(complex.vertices[vertex]);
    if (!own.intersects(box)) continue;
    part.triangles.push_back(complex.triangles[i]);
    part.owner.push_back(complex.owner[i]);
  }
  return part;
}

Wedges::Wedges(const CrackComplex& complex, const Edges& edges)
    : complex_(complex), edges_(edges), ring_(edges.sides), loose_(edges.count()), repeats_(edges.count()) {
  for (int edge = 0; edge < edges.count(); ++edge) {
    loose_[edge] = !sort_around(edge) || !hand_over(edge);
    std::vector<int> around;
    for (int i = edges.first[edge]; i < edges.first[edge + 1]; ++i) {
      const CrackComplex::Owner& owner = complex.owner[ring_[i].face];
      around.push_back(ring_[i].forward ? owner.outside : owner.inside);
    }
    std::sort(around.begin(), around.end());
    repeats_[edge] = std::adjacent_find(around.begin(), around.end()) != around.end();
  }
}

// False when two triangles overlap.
bool Wedges::sort_around(int edge) {
  const auto begin = ring_.begin() + edges_.first[edge], end = ring_.begin() + edges_.first[edge + 1];
  const Vec3 &a = complex_.vertices[edges_.ends[edge][0]], &b = complex_.vertices[edges_.ends[edge][1]];
  const auto tip = [&](const HalfEdge& side) -> const Vec3& {
    return complex_.vertices[complex_.triangles[side.face][(side.corner + 2) % 3]];
  };
  const Vec3& start = tip(*begin);
  bool overlap = false;
  // Angles from the first triangle: 0 none, 1 less than half a turn, 2 half, 3 more.
  const auto quarter = [&](const HalfEdge& side) {
    const int turn = orientation(a, b, start, tip(side));
    if (turn != 0) return turn > 0 ? 1 : 3;
    return on_same_side(a, b, start, tip(side)) ? 0 : 2;
  };
  const auto before = [&](const HalfEdge& x, const HalfEdge& y) {
    const int of_x = quarter(x), of_y = quarter(y);
    return of_x != of_y ? of_x < of_y : orientation(a, b, tip(x), tip(y)) > 0;
  };
  if (end - begin > 2) std::sort(begin + 1, end, before);
  for (auto i = begin; i + 1 < end; ++i) {
    overlap |= orientation(a, b, tip(*i), tip(*(i + 1))) == 0 && on_same_side(a, b, tip(*i), tip(*(i + 1)));
  }
  return !overlap;
}

bool Wedges::hand_over(int edge) const {
  const int first = edges_.first[edge], count = edges_.first[edge + 1] - first;
  for (int i = 0; i < count; ++i) {
    const HalfEdge &here = ring_[first + i], &next = ring_[first + (i + 1) % count];
    if (complex_.region({here.face, here.forward ? 1 : 0}) != complex_.region({next.face, next.forward ? 0 : 1})) {
      return false;
    }
  }
  return true;
}

// The normal of a triangle that runs forward along the edge points to growing angles, so its outer side bounds the
// wedge after it.
CrackSide Wedges::across(const CrackSide& at, int corner) const {
  const int edge = edges_.of_face[at.triangle][corner];
  const int first = edges_.first[edge], count = edges_.first[edge + 1] - first;
  int i = 0;
  while (ring_[first + i].face != at.triangle) ++i;
  const bool after = ring_[first + i].forward == (at.side == 1);
  const HalfEdge& other = ring_[first + (after ? i + 1 : i + count - 1) % count];
  return {other.face, other.forward == after ? 0 : 1};
}

}  // namespace sunder::geometry::detail
