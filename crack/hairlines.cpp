#include "crack/hairlines.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>
#include <set>

#include "crack/detail/crossings.h"
#include "crack/detail/panels.h"

namespace sunder::crack {

namespace {

using detail::Edge;
using detail::edge_of;
using detail::Panel;
using detail::PanelsByEdge;
using detail::Sheets;

constexpr double least_cosine =
    0.3;                             // between a corner's normal and those of its faces: its copies stay on their sides
constexpr double shortest_edge = 2;  // in widths
constexpr double smoothing = 4;      // radius over which normals are averaged, in widths
constexpr double steepest = 0.25;    // opening of a gap over the distance from where its sheet ends

/// One face of a sheet, turned to fit it, with its middle.
struct Facet {
  int panel = 0;
  std::vector<int> loop;
  Vec3 middle = Vec3::Zero(), normal = Vec3::Zero();
  double area = 0;
};

Facet facet_of(const Panel& panel, int number, bool turned, const std::vector<Vec3>& vertices) {
  Facet facet{number, panel.loop};
  if (turned) std::reverse(facet.loop.begin(), facet.loop.end());
  for (const int v : facet.loop) facet.middle += vertices[static_cast<std::size_t>(v)];
  facet.middle /= static_cast<double>(facet.loop.size());
  for (std::size_t i = 0; i < facet.loop.size(); ++i) {
    const Vec3 a = vertices[static_cast<std::size_t>(facet.loop[i])] - facet.middle;
    const Vec3 b = vertices[static_cast<std::size_t>(facet.loop[(i + 1) % facet.loop.size()])] - facet.middle;
    facet.normal += a.cross(b) / 2;
  }
  facet.area = facet.normal.norm();
  facet.normal.normalize();
  return facet;
}

/// Corners that sheets share.
std::set<int> shared_corners(const std::vector<Panel>& panels, const Sheets& sheets) {
  std::map<int, int> first;
  std::set<int> shared;
  for (std::size_t f = 0; f < panels.size(); ++f)
    for (const int v : panels[f].loop)
      if (first.try_emplace(v, sheets.sheet[f]).first->second != sheets.sheet[f]) shared.insert(v);
  return shared;
}

double distance_to_segment(const Vec3& a, const Vec3& b, const Vec3& x) {
  const double along = std::clamp((x - a).dot(b - a) / (b - a).squaredNorm(), 0.0, 1.0);
  return (a + along * (b - a) - x).norm();
}

/// A connected sheet: the normals of its corners, and where it ends.
class Sheet {
 public:
  Sheet(const std::vector<Facet>& facets, const PanelsByEdge& by_edge, const std::set<int>& shared,
        const std::vector<Vec3>& vertices, double width)
      : vertices_(vertices), width_(width), border_(shared) {
    std::map<int, Vec3> normals;
    for (const Facet& facet : facets)
      for (std::size_t i = 0; i < facet.loop.size(); ++i) {
        normals.try_emplace(facet.loop[i], Vec3::Zero()).first->second += facet.area * facet.normal;
        const Edge edge = edge_of(facet.loop, i);
        if (by_edge.at(edge).size() == 2) continue;
        edges_.insert(edge);
        border_.insert({edge.first, edge.second});
      }
    for (const auto& [vertex, normal] : normals) corners_.push_back({at(vertex), normal});
    for (const auto& [vertex, normal] : normals) normals_[vertex] = normal_at(at(vertex), Vec3::Zero());
    for (const Facet& facet : facets)
      for (const int v : facet.loop)
        if (!(facet.normal.dot(normals_.at(v)) > least_cosine)) border_.insert(v);
    for (const auto& [vertex, normal] : normals_)
      if (border_.contains(vertex)) ends_.push_back(at(vertex));
  }

  bool is_border(int vertex) const { return border_.contains(vertex); }
  /// An edge across the sheet with both ends on its border: the gap would close along it.
  bool is_bridge(const Edge& edge) const {
    return is_border(edge.first) && is_border(edge.second) && !edges_.contains(edge);
  }
  const Vec3& normal(int vertex) const { return normals_.at(vertex); }

  /// `own` and those of the corners around, so that neighbours nearer than the gap is wide part in the same direction.
  Vec3 normal_at(const Vec3& x, const Vec3& own) const {
    const double reach = smoothing * width_;
    Vec3 sum = own;
    for (const Corner& corner : corners_)
      if (const double distance = (corner.at - x).norm(); distance < reach)
        sum += (1 - distance / reach) * corner.normal;
    return sum.normalized();
  }

  /// Half of the gap's width at a point of the sheet: it opens gently from where the sheet ends.
  double half_width(const Vec3& x) const {
    double nearest = 2 * width_ / steepest;
    for (const Vec3& end : ends_) nearest = std::min(nearest, (end - x).norm());
    for (const auto& [a, b] : edges_) nearest = std::min(nearest, distance_to_segment(at(a), at(b), x));
    return std::min(width_ / 2, steepest * nearest);
  }

 private:
  struct Corner {
    Vec3 at, normal;  // the normal weighted by area
  };

  const Vec3& at(int vertex) const { return vertices_[static_cast<std::size_t>(vertex)]; }

  const std::vector<Vec3>& vertices_;
  double width_;
  std::vector<Corner> corners_;
  std::set<int> border_;
  std::set<Edge> edges_;  // those of its rim
  std::vector<Vec3> ends_;
  std::map<int, Vec3> normals_;
};

/// The two sides of a sheet.
class Gap {
 public:
  Gap(detail::FineMesh& mesh, const Sheet& sheet) : mesh_(mesh), sheet_(sheet) {}

  void add(const Facet& facet) {
    panel_ = facet.panel;
    const Vec3 offset = sheet_.half_width(facet.middle) * sheet_.normal_at(facet.middle, facet.area * facet.normal);
    const int above = add_vertex(facet.middle + offset);
    const int below = add_vertex(facet.middle - offset);
    for (std::size_t i = 0; i < facet.loop.size(); ++i) {
      const Edge edge = edge_of(facet.loop, i);
      const int a = facet.loop[i], b = facet.loop[(i + 1) % facet.loop.size()];
      if (!sheet_.is_bridge(edge)) {
        add_sides(sides_of(a), sides_of(b), {above, below});
        continue;
      }
      const Sides middle = middle_of(edge);
      add_sides(sides_of(a), middle, {above, below});
      add_sides(middle, sides_of(b), {above, below});
    }
  }

 private:
  /// A point of the sheet on the two sides of the gap.
  struct Sides {
    int above, below;
  };

  int add_vertex(const Vec3& x) {
    mesh_.vertices.push_back(x);
    return static_cast<int>(mesh_.vertices.size()) - 1;
  }

  Sides open(const Vec3& x, const Vec3& normal) {
    const Vec3 offset = sheet_.half_width(x) * normal;
    return {add_vertex(x + offset), add_vertex(x - offset)};
  }

  /// Seen from above, where the normal points, the loop turns counter-clockwise.
  void add_sides(const Sides& a, const Sides& b, const Sides& middle) {
    mesh_.faces.push_back({a.above, b.above, middle.above});
    mesh_.faces.push_back({b.below, a.below, middle.below});
    mesh_.source.resize(mesh_.faces.size(), panel_);
  }

  /// Corners on the border have no copies.
  Sides sides_of(int vertex) {
    if (sheet_.is_border(vertex)) return {vertex, vertex};
    const auto known = corners_.find(vertex);
    if (known != corners_.end()) return known->second;
    const Vec3 x = mesh_.vertices[static_cast<std::size_t>(vertex)];
    return corners_[vertex] = open(x, sheet_.normal(vertex));
  }

  Sides middle_of(const Edge& edge) {
    const auto known = middles_.find(edge);
    if (known != middles_.end()) return known->second;
    const Vec3 x =
        (mesh_.vertices[static_cast<std::size_t>(edge.first)] + mesh_.vertices[static_cast<std::size_t>(edge.second)]) /
        2;
    return middles_[edge] = open(x, sheet_.normal_at(x, sheet_.normal(edge.first) + sheet_.normal(edge.second)));
  }

  detail::FineMesh& mesh_;
  const Sheet& sheet_;
  int panel_ = 0;
  std::map<int, Sides> corners_;
  std::map<Edge, Sides> middles_;
};

/// The gaps around all sheets, over the vertices of the extraction and new ones.
struct Gaps {
  detail::FineMesh mesh;         // source: the panel
  std::vector<int> around, gap;  // per triangle: region and number of the gap
  int count = 0;
};

Gaps gaps_of(const std::vector<Panel>& panels, const PanelsByEdge& by_edge, const Sheets& sheets,
             const std::vector<Vec3>& vertices, double width) {
  Gaps gaps{{vertices, {}, {}}, {}, {}, sheets.count};
  std::vector<std::vector<Facet>> facets(static_cast<std::size_t>(sheets.count));
  for (std::size_t f = 0; f < panels.size(); ++f)
    facets[static_cast<std::size_t>(sheets.sheet[f])].push_back(
        facet_of(panels[f], static_cast<int>(f), sheets.turned[f] != 0, vertices));
  const std::set<int> shared = shared_corners(panels, sheets);
  for (std::size_t sheet = 0; sheet < facets.size(); ++sheet) {
    const Sheet shape(facets[sheet], by_edge, shared, vertices, width);
    Gap gap(gaps.mesh, shape);
    for (const Facet& facet : facets[sheet]) {
      gap.add(facet);
      gaps.around.resize(gaps.mesh.faces.size(), panels[static_cast<std::size_t>(facet.panel)].region);
      gaps.gap.resize(gaps.mesh.faces.size(), static_cast<int>(sheet));
    }
  }
  return gaps;
}

/// Panels whose sides cross those of others or a crack between regions.
std::set<int> crossing_panels(const Gaps& gaps, const geometry::RegionBoundary& boundary) {
  detail::FineMesh mesh = gaps.mesh;
  std::vector<char> moved(mesh.faces.size(), 1);
  const int first = static_cast<int>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), boundary.vertices.begin(), boundary.vertices.end());
  for (const geometry::RegionBoundary::Face& face : boundary.faces) {
    for (std::size_t i = 2; i < face.loop.size() && face.outside >= 0; ++i)
      mesh.faces.push_back({first + face.loop[0], first + face.loop[i - 1], first + face.loop[i]});
    mesh.source.resize(mesh.faces.size(), -1);
  }
  moved.resize(mesh.faces.size(), 0);
  std::set<int> panels;
  for (const auto& [low, high] : detail::crossings(mesh, mesh.vertices, moved))
    panels.insert({mesh.source[static_cast<std::size_t>(low)], mesh.source[static_cast<std::size_t>(high)]});
  panels.erase(-1);
  return panels;
}

/// Does a line from x upwards pass through the triangle? Triangles that share an edge share none of such lines.
bool below(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& x) {
  int left = 0;  // edges across the line's plane, left of it
  const std::array<const Vec3*, 4> corners = {&a, &b, &c, &a};
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec3 &p = *corners[i], &q = *corners[i + 1];
    if ((p.y() > x.y()) == (q.y() > x.y())) continue;
    const Vec3 &low = p.y() < q.y() ? p : q, &high = p.y() < q.y() ? q : p;
    left += low.x() + (x.y() - low.y()) / (high.y() - low.y()) * (high.x() - low.x()) < x.x();
  }
  const Vec3 normal = (b - a).cross(c - a);
  return left == 1 && normal.dot(a - x) * normal.z() > 0;
}

bool lies_in(const geometry::RegionBoundary& boundary, int region, const Vec3& x) {
  const auto at = [&](int v) -> const Vec3& { return boundary.vertices[static_cast<std::size_t>(v)]; };
  bool inside = false;
  for (const geometry::RegionBoundary::Face& face : boundary.faces)
    if (face.inside == region || face.outside == region)
      for (std::size_t i = 2; i < face.loop.size(); ++i)
        inside ^= below(at(face.loop[0]), at(face.loop[i - 1]), at(face.loop[i]), x);
  return inside;
}

/// Panels of sheets that surface detail moved a crack past, so that they lie in another region now.
std::set<int> misplaced_panels(const Gaps& gaps, const geometry::RegionBoundary& boundary) {
  std::set<int> panels;
  std::vector<int> misplaced(static_cast<std::size_t>(gaps.count), -1);  // by gap, -1: not known
  for (std::size_t t = 0; t < gaps.mesh.faces.size() && !boundary.faces.empty(); ++t) {
    int& known = misplaced[static_cast<std::size_t>(gaps.gap[t])];
    const Vec3& middle = gaps.mesh.vertices[static_cast<std::size_t>(gaps.mesh.faces[t][2])];
    if (known < 0) known = lies_in(boundary, gaps.around[t], middle) ? 0 : 1;
    if (known > 0) panels.insert(gaps.mesh.source[t]);
  }
  return panels;
}

/// Gaps without those panels that would make them invalid.
Gaps valid_gaps(std::vector<Panel> panels, const std::vector<Vec3>& vertices, double width,
                const geometry::RegionBoundary& boundary) {
  while (true) {
    const PanelsByEdge by_edge = detail::panels_by_edge(panels);
    const Sheets sheets = detail::find_sheets(panels, by_edge);
    std::set<int> bad = sheets.one_sided;
    if (bad.empty()) {
      Gaps gaps = gaps_of(panels, by_edge, sheets, vertices, width);
      bad = crossing_panels(gaps, boundary);
      if (bad.empty()) bad = misplaced_panels(gaps, boundary);
      if (bad.empty()) return gaps;
    }
    panels = detail::without(panels, bad);
  }
}

}  // namespace

Hairlines add_hairlines(const Extraction& extraction, double width, geometry::RegionBoundary& boundary) {
  const std::vector<Vec3>& vertices = extraction.vertices;
  const Gaps gaps = valid_gaps(
      detail::without_branches(
          detail::without_short_edges(detail::shown_panels(extraction), vertices, shortest_edge * width), vertices),
      vertices, width, boundary);
  if (boundary.faces.empty()) boundary = {vertices, {}, 1};
  Hairlines result;
  result.first_gap = boundary.region_count;
  result.gaps = gaps.count;
  result.faces = static_cast<long>(std::set<int>(gaps.mesh.source.begin(), gaps.mesh.source.end()).size());
  result.left_out = std::count_if(extraction.faces.begin(), extraction.faces.end(),
                                  [](const CrackFace& face) { return face.kind == FaceKind::partial; }) -
                    result.faces;
  // The boundary may have more vertices than the extraction by now.
  const int shift = static_cast<int>(boundary.vertices.size()) - static_cast<int>(vertices.size());
  const auto number = [&](int v) { return v < static_cast<int>(vertices.size()) ? v : v + shift; };
  boundary.vertices.insert(boundary.vertices.end(), gaps.mesh.vertices.begin() + static_cast<long>(vertices.size()),
                           gaps.mesh.vertices.end());
  for (std::size_t t = 0; t < gaps.mesh.faces.size(); ++t) {
    const auto& [a, b, c] = gaps.mesh.faces[t];
    boundary.faces.push_back({{number(a), number(b), number(c)}, result.first_gap + gaps.gap[t], gaps.around[t]});
  }
  boundary.region_count += gaps.count;
  return result;
}

}  // namespace sunder::crack
