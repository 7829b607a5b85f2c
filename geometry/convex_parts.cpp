#include "geometry/convex_parts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "geometry/detail/bulge.h"
#include "geometry/detail/halving.h"
#include "geometry/detail/hull.h"
#include "geometry/detail/inside.h"
#include "geometry/detail/shells.h"
#include "geometry/detail/splitting.h"

namespace sunder::geometry {
namespace {

using detail::CellPart;

constexpr int kLeastVertices = 8;
// Where the bulge of a part is measured.
constexpr int kSurfacePoints = 200;
// What may stand out of a hull: this share of the gap, and of the thickness of the part, so that a plate stays flat.
constexpr double kHullShare = 0.5, kThicknessShare = 0.1;
// Hulls that hold less air than a layer this share of the gap thick are not worth a split however deep a few pits are:
// rough crack faces would take all parts there are.
constexpr double kLayer = 0.25;

struct Part {
  CellPart piece;
  TriangleMesh hull;
  std::vector<detail::SurfacePoint> points;  // of the surface
  std::vector<double> bulges;                // at the points [m]
  double left_out = 0;                       // [m]
  double excess = 0;                         // hull volume - solid volume, at least 0 [m^3]
  bool settled = false;                      // good enough, or cannot be split

  double bulge() const { return bulges.empty() ? 0 : *std::max_element(bulges.begin(), bulges.end()); }
  double urgency() const { return settled ? -1 : excess; }
};

double thickness(const std::vector<detail::SurfacePoint>& surface) {
  std::vector<Vec3> points;
  for (const detail::SurfacePoint& point : surface) points.push_back(point.position);
  const Mat3 axes = detail::principal_axes(points);
  Box box;
  for (const Vec3& x : points) box.extend(axes.transpose() * x);
  return points.empty() ? 0 : box.sizes().minCoeff();
}

double area(const TriangleMesh& mesh) {
  double sum = 0;
  for (const auto& [a, b, c] : mesh.faces) {
    sum += (mesh.vertices[b] - mesh.vertices[a]).cross(mesh.vertices[c] - mesh.vertices[a]).norm() / 2;
  }
  return sum;
}

class Splitter {
 public:
  Splitter(const TriangleMesh& solid, const ConvexPartsSettings& settings)
      : settings_(settings), solid_(solid), gap_(settings.gap * bounds(solid).sizes().maxCoeff()) {}

  ConvexParts split() {
    std::vector<Part> parts = {make_part(whole())};
    if (parts[0].hull.faces.empty()) return {};
    while (static_cast<int>(parts.size()) < settings_.max_parts) {
      const auto worst = std::max_element(parts.begin(), parts.end(),
                                          [](const Part& a, const Part& b) { return a.urgency() < b.urgency(); });
      if (worst->settled) break;
      std::optional<std::array<Part, 2>> halves = halve(*worst);
      worst->settled = !halves;
      if (!halves) continue;
      *worst = std::move((*halves)[0]);
      parts.push_back(std::move((*halves)[1]));
    }
    return result(std::move(parts));
  }

 private:
  Part make_part(CellPart piece) {
    Part part;
    part.points = detail::even_points(piece.vertices, piece.surface, kSurfacePoints);
    const double tolerance = std::min(kHullShare * gap_, kThicknessShare * thickness(part.points));
    detail::SmallHull hull =
        detail::small_convex_hull(corners(piece), tolerance, std::max(kLeastVertices, settings_.max_hull_vertices));
    part.hull = std::move(hull.mesh);
    part.left_out = hull.left_out;
    part.excess = std::max(0.0, detail::volume(part.hull) - piece.volume());
    part.bulges = detail::bulges(part.hull, part.points, part.left_out);
    part.settled = part.bulge() <= gap_ || part.excess <= kLayer * gap_ * area(part.hull);
    part.piece = std::move(piece);
    return part;
  }

  // Without the vertices that no face uses.
  CellPart whole() const {
    TriangleMesh mesh = detail::compact(solid_.vertices, solid_.faces);
    const int count = static_cast<int>(mesh.vertices.size());
    return {std::move(mesh.vertices), count, std::move(mesh.faces), {}, {}};
  }

  // Where the cell's own corners lie in the solid, the surface alone would leave them out.
  std::vector<Vec3> corners(const CellPart& piece) {
    std::vector<Vec3> points(piece.vertices.begin(), piece.vertices.begin() + piece.on_surface);
    for (const Vec3& corner : detail::cell_corners(piece.planes)) {
      if (!inside_) inside_.emplace(solid_);
      if ((*inside_)(corner)) points.push_back(corner);
    }
    return points;
  }

  std::optional<std::array<Part, 2>> halve(const Part& part) {
    detail::Halves halves =
        detail::halve(part.piece, detail::splitting_plane(part.piece, part.hull, part.points, part.bulges));
    std::array<Part, 2> parts = {make_part(std::move(halves.below)), make_part(std::move(halves.above))};
    if (parts[0].hull.faces.empty() || parts[1].hull.faces.empty()) return std::nullopt;
    return parts;
  }

  static ConvexParts result(std::vector<Part> parts) {
    ConvexParts out;
    for (Part& part : parts) {
      out.hulls.push_back(std::move(part.hull));
      out.left_out = std::max(out.left_out, part.left_out);
      out.bulge = std::max(out.bulge, part.bulge());
    }
    return out;
  }

  ConvexPartsSettings settings_;
  const TriangleMesh& solid_;
  double gap_;                                // [m]
  std::optional<detail::InsideTest> inside_;  // made when first asked for
};

}  // namespace

ConvexParts convex_parts(const TriangleMesh& solid, const ConvexPartsSettings& settings) {
  if (solid.faces.empty()) return {};
  return Splitter(solid, settings).split();
}

}  // namespace sunder::geometry
