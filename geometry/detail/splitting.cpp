#include "geometry/detail/splitting.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "geometry/detail/hull.h"

namespace sunder::geometry::detail {
namespace {

// Planes are tried across each axis at the borders of this many equal slabs, and at those of so many for pairs.
constexpr int kSlabs = 12, kPairSlabs = 4;
// So many planes of the surface are tried, with cosines between their normals below this.
constexpr int kHollows = 3;
constexpr double kSameDirection = 0.9;
// Trial hulls only rank planes: a few vertices, and a sample of the faces, are enough.
constexpr int kTrialVertices = 24, kTrialFaces = 200;
// A single plane that saves this share of what the hull holds too much is taken without asking for pairs.
constexpr double kSaving = 0.6;
// A pair has to save this many times what the best single plane does: the next plane will save something, too.
constexpr double kPairGain = 1.3;
// An axis shorter than this share of the longest is not worth a plane.
constexpr double kFlat = 1e-6;

using Points = std::vector<Vec3>;

struct Span {
  Vec3 axis = Vec3::Zero();
  double low = std::numeric_limits<double>::infinity(), high = -low;

  void add(double x) { low = std::min(low, x), high = std::max(high, x); }
  double length() const { return high - low; }
  Plane border(int i, int slabs) const { return {axis, low + length() * i / slabs}; }
};

// What the hulls hold after a plane is taken [m^3].
struct Trial {
  Plane plane;
  double volume = std::numeric_limits<double>::infinity();
};

class Trials {
 public:
  Trials(const CellPart& part, const TriangleMesh& hull, const std::vector<SurfacePoint>& surface)
      : points_(positions(surface)), edges_(sample_of_edges(part)) {
    const Mat3 axes = principal_axes(points_);
    points_.insert(points_.end(), hull.vertices.begin(), hull.vertices.end());
    double longest = 0;
    for (int i = 0; i < 3; ++i) {
      Span span{.axis = axes.col(i)};
      for (const Vec3& x : hull.vertices) span.add(span.axis.dot(x));
      longest = std::max(longest, span.length());
      spans_.push_back(span);
    }
    std::erase_if(spans_, [&](const Span& span) { return !(span.length() > kFlat * longest); });
  }

  Trial best_plane(const std::vector<Plane>& others) const {
    std::vector<Plane> planes = others;
    for (const Span& span : spans_) {
      for (int i = 1; i < kSlabs; ++i) planes.push_back(span.border(i, kSlabs));
    }
    Trial best;
    for (const Plane& plane : planes) {
      const auto [below, above] = halves(plane);
      const double volume = hull_volume(below) + hull_volume(above);
      if (volume < best.volume) best = {plane, volume};
    }
    return best;
  }

  // As the volumes of two halves are, with about the same error.
  double undivided() const { return hull_volume(points_, 2 * kTrialVertices); }

  // The plane across the longer axis of the best pair.
  Trial best_pair() const {
    Trial best;
    for (std::size_t i = 0; i < spans_.size(); ++i) {
      for (std::size_t j = i + 1; j < spans_.size(); ++j) {
        const bool rising = spans_[i].length() < spans_[j].length();
        const Trial trial = best_pair(spans_[rising ? j : i], spans_[rising ? i : j]);
        if (trial.volume < best.volume) best = trial;
      }
    }
    return best;
  }

 private:
  using Edge = std::array<Vec3, 2>;

  static Points positions(const std::vector<SurfacePoint>& surface) {
    Points result;
    for (const SurfacePoint& point : surface) result.push_back(point.position);
    return result;
  }

  static std::vector<Edge> sample_of_edges(const CellPart& part) {
    std::vector<Edge> edges;
    const std::size_t stride = 1 + part.surface.size() / kTrialFaces;
    for (std::size_t face = 0; face < part.surface.size(); face += stride) {
      const auto& [a, b, c] = part.surface[face];
      for (const auto& [from, to] : {std::array{a, b}, {b, c}, {c, a}}) {
        edges.push_back({part.vertices[from], part.vertices[to]});
      }
    }
    return edges;
  }

  Trial best_pair(const Span& longer, const Span& shorter) const {
    Trial best;
    for (int i = 1; i < kPairSlabs; ++i) {
      const Plane plane = longer.border(i, kPairSlabs);
      const std::array<Points, 2> parts = halves(plane);
      for (int j = 1; j < kPairSlabs; ++j) {
        double volume = 0;
        for (const Points& half : parts) {
          for (const Points& quarter : sorted(half, shorter.border(j, kPairSlabs))) volume += hull_volume(quarter);
        }
        if (volume < best.volume) best = {plane, volume};
      }
    }
    return best;
  }

  static double hull_volume(const Points& points, int max_vertices = kTrialVertices) {
    return volume(small_convex_hull(points, 0, max_vertices).mesh);
  }

  static std::array<Points, 2> sorted(const Points& points, const Plane& plane) {
    std::array<Points, 2> sides;
    for (const Vec3& x : points) sides[plane.distance(x) > 0].push_back(x);
    return sides;
  }

  // With the points where the plane cuts the surface.
  std::array<Points, 2> halves(const Plane& plane) const {
    std::array<Points, 2> sides = sorted(points_, plane);
    for (const auto& [a, b] : edges_) {
      const double from = plane.distance(a), to = plane.distance(b);
      if (from * to >= 0) continue;
      const Vec3 crossing = a + (b - a) * (from / (from - to));
      for (Points& side : sides) side.push_back(crossing);
    }
    return sides;
  }

  Points points_;
  std::vector<Edge> edges_;
  std::vector<Span> spans_;
};

// The planes of the surface at the points with the largest bulges, which turn away from each other.
std::vector<Plane> planes_of_hollows(const std::vector<SurfacePoint>& points, const std::vector<double>& bulges) {
  std::vector<Plane> planes;
  for (int i = 0; i < kHollows; ++i) {
    int deepest = -1;
    for (int j = 0; j < static_cast<int>(points.size()); ++j) {
      const bool is_new = std::all_of(planes.begin(), planes.end(), [&](const Plane& plane) {
        return std::abs(plane.normal.dot(points[j].normal)) < kSameDirection;
      });
      if (is_new && bulges[j] > (deepest < 0 ? 0 : bulges[deepest])) deepest = j;
    }
    if (deepest < 0) break;
    const SurfacePoint& point = points[deepest];
    planes.push_back({point.normal, point.normal.dot(point.position)});
  }
  return planes;
}

}  // namespace

Plane splitting_plane(const CellPart& part, const TriangleMesh& hull, const std::vector<SurfacePoint>& points,
                      const std::vector<double>& bulges) {
  const Trials trials(part, hull, points);
  const Trial plane = trials.best_plane(planes_of_hollows(points, bulges));
  const double held = trials.undivided(), saved = held - plane.volume;
  if (saved > kSaving * (volume(hull) - part.volume())) return plane.plane;
  const Trial pair = trials.best_pair();
  return held - pair.volume > kPairGain * saved ? pair.plane : plane.plane;
}

}  // namespace sunder::geometry::detail
