#include "geometry/convex_parts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "geometry/detail/halving.h"
#include "geometry/detail/hull.h"
#include "geometry/detail/inside.h"
#include "geometry/detail/shells.h"

namespace sunder::geometry {
namespace {

using detail::CellPart;
using detail::Plane;

// Cutting planes are tried across each principal axis at the borders of this many equal slabs.
constexpr int kSlabs = 12;
// Trial hulls only rank planes: few directions, and a sample of the faces, are enough.
constexpr int kTrialDirections = 42;
constexpr int kTrialFaces = 2000;
// A first cut through a hollow saves nothing, the next one does. Among planes that save about as much, one near the
// middle of a long axis is taken: the cost of a plane at the very end, and of a vanishing axis, as shares of the hulls'
// volume.
constexpr double kOffCentre = 0.05;
constexpr double kShortAxis = 0.2;

struct Part {
  CellPart piece;
  TriangleMesh hull;
  double excess = 0;     // hull volume - solid volume, at least 0
  bool settled = false;  // cannot be split
};

// The farthest points along every trial direction.
struct Extremes {
  std::array<double, kTrialDirections> height;
  std::array<Vec3, kTrialDirections> point;

  Extremes() { height.fill(-std::numeric_limits<double>::infinity()); }

  void add(const Vec3& x, const Eigen::Matrix3Xd& directions) {
    for (int i = 0; i < kTrialDirections; ++i) {
      const double h = directions.col(i).dot(x);
      if (h > height[i]) height[i] = h, point[i] = x;
    }
  }
  void add(const Extremes& other) {
    for (int i = 0; i < kTrialDirections; ++i) {
      if (other.height[i] > height[i]) height[i] = other.height[i], point[i] = other.point[i];
    }
  }
  double hull_volume() const {
    std::vector<Vec3> points;
    for (int i = 0; i < kTrialDirections; ++i) {
      if (height[i] > -std::numeric_limits<double>::infinity() &&
          std::find(points.begin(), points.end(), point[i]) == points.end()) {
        points.push_back(point[i]);
      }
    }
    return detail::rough_hull_volume(points);
  }
};

struct Trial {
  Plane plane;
  double cost = std::numeric_limits<double>::infinity();
};

// Sorts a sample of the part into slabs; edges add their crossings to the slabs on both sides.
std::array<Extremes, kSlabs> slabs(const CellPart& part, const Vec3& axis, double low, double width,
                                   const Eigen::Matrix3Xd& directions) {
  std::array<Extremes, kSlabs> result;
  const auto slab = [&](double height) { return std::clamp(static_cast<int>((height - low) / width), 0, kSlabs - 1); };
  const std::size_t stride = 1 + part.surface.size() / kTrialFaces;
  for (std::size_t face = 0; face < part.surface.size(); face += stride) {
    for (int k = 0; k < 3; ++k) {
      const Vec3 &a = part.vertices[part.surface[face][k]], &b = part.vertices[part.surface[face][(k + 1) % 3]];
      const double from = axis.dot(a), to = axis.dot(b);
      result[slab(from)].add(a, directions);
      const auto [first, last] = std::minmax({slab(from), slab(to)});
      for (int border = first; border < last; ++border) {
        const Vec3 crossing = a + (b - a) * ((low + (border + 1) * width - from) / (to - from));
        result[border].add(crossing, directions);
        result[border + 1].add(crossing, directions);
      }
    }
  }
  return result;
}

struct Span {
  Vec3 axis;
  double low = std::numeric_limits<double>::infinity(), high = -low;

  double length() const { return high - low; }
};

Span span_along(const CellPart& part, const Vec3& axis) {
  Span span{.axis = axis};
  for (const Vec3& x : part.vertices) {
    span.low = std::min(span.low, axis.dot(x));
    span.high = std::max(span.high, axis.dot(x));
  }
  return span;
}

Trial best_across(const CellPart& part, const Span& span, double longest, const Eigen::Matrix3Xd& directions) {
  const double width = span.length() / kSlabs;
  if (!(width > 0)) return {};
  const std::array<Extremes, kSlabs> slab = slabs(part, span.axis, span.low, width, directions);
  std::array<Extremes, kSlabs> above = slab;  // everything from a slab upwards
  for (int i = kSlabs - 1; i > 0; --i) above[i - 1].add(above[i]);
  Extremes below;
  Trial best;
  for (int border = 0; border + 1 < kSlabs; ++border) {
    below.add(slab[border]);
    const double off_centre = std::abs(2.0 * (border + 1) / kSlabs - 1);
    const double penalty = kOffCentre * off_centre + kShortAxis * (1 - span.length() / longest);
    const double cost = (below.hull_volume() + above[border + 1].hull_volume()) * (1 + penalty);
    if (cost < best.cost) best = {{span.axis, span.low + (border + 1) * width}, cost};
  }
  return best;
}

Plane best_plane(const CellPart& part) {
  const Mat3 axes = detail::principal_axes(part.vertices);
  const Eigen::Matrix3Xd directions = detail::even_directions(kTrialDirections);
  std::array<Span, 3> spans;
  for (int i = 0; i < 3; ++i) spans[i] = span_along(part, axes.col(i));
  const double longest = std::max({spans[0].length(), spans[1].length(), spans[2].length()});
  Trial best;
  for (const Span& span : spans) {
    const Trial trial = best_across(part, span, longest, directions);
    if (trial.cost < best.cost) best = trial;
  }
  return best.plane;
}

double total_excess(const std::vector<Part>& parts) {
  double sum = 0;
  for (const Part& part : parts) sum += part.excess;
  return sum;
}

class Splitter {
 public:
  Splitter(const TriangleMesh& solid, const ConvexPartsSettings& settings)
      : settings_(settings), inside_(solid), whole_{solid.vertices, solid.faces, {}, {}} {}

  ConvexParts split() {
    std::vector<Part> parts = {make_part(whole_)};
    if (parts[0].hull.faces.empty()) return {};
    const double volume = whole_.volume();
    while (static_cast<int>(parts.size()) < settings_.max_parts && total_excess(parts) > settings_.excess * volume) {
      const auto worst = std::max_element(parts.begin(), parts.end(), [](const Part& a, const Part& b) {
        return (a.settled ? -1 : a.excess) < (b.settled ? -1 : b.excess);
      });
      if (worst->settled) break;
      std::optional<std::array<Part, 2>> halves = halve(*worst);
      worst->settled = !halves;
      if (!halves) continue;
      *worst = std::move((*halves)[0]);
      parts.push_back(std::move((*halves)[1]));
    }
    return result(std::move(parts), volume);
  }

 private:
  Part make_part(CellPart piece) const {
    std::vector<Vec3> points = detail::compact(piece.vertices, piece.surface).vertices;
    // Where the cell's own corners lie in the solid, the surface alone would leave them out.
    for (const Vec3& corner : detail::cell_corners(piece.planes)) {
      if (inside_(corner)) points.push_back(corner);
    }
    Part part;
    detail::SmallHull hull = detail::small_convex_hull(points, std::max(8, settings_.max_hull_vertices));
    part.hull = std::move(hull.mesh);
    part.excess = std::max(0.0, hull.full_volume - piece.volume());
    part.piece = std::move(piece);
    return part;
  }

  std::optional<std::array<Part, 2>> halve(const Part& part) const {
    detail::Halves halves = detail::halve(part.piece, best_plane(part.piece));
    std::array<Part, 2> result = {make_part(std::move(halves.below)), make_part(std::move(halves.above))};
    if (result[0].hull.faces.empty() || result[1].hull.faces.empty()) return std::nullopt;
    return result;
  }

  static ConvexParts result(std::vector<Part> parts, double solid_volume) {
    ConvexParts out;
    double sum = 0;
    for (Part& part : parts) {
      sum += detail::volume(part.hull);
      out.hulls.push_back(std::move(part.hull));
    }
    out.excess = (sum - solid_volume) / solid_volume;
    return out;
  }

  ConvexPartsSettings settings_;
  detail::InsideTest inside_;
  CellPart whole_;
};

}  // namespace

ConvexParts convex_parts(const TriangleMesh& solid, const ConvexPartsSettings& settings) {
  if (solid.faces.empty()) return {};
  return Splitter(solid, settings).split();
}

}  // namespace sunder::geometry
