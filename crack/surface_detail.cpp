#include "crack/surface_detail.h"

#include <cmath>

#include "crack/detail/chevrons.h"
#include "crack/detail/clearance.h"
#include "crack/detail/grain.h"
#include "crack/detail/refine.h"
#include "crack/detail/relief.h"
#include "crack/detail/sheets.h"
#include "crack/detail/surface_field.h"
#include "crack/time_field.h"

namespace sunder::crack {

namespace {

using namespace detail;

constexpr double time_grid = 1.5;        // finest grid of the damage time, in spacings: a finer one has holes
constexpr double growth_outside = 1;     // of edges, per distance from the body
constexpr double largest_share = 0.05;   // of the body's diagonal: no vertex moves farther
constexpr double finest_grid = 1 << 18;  // cells along the body's diagonal
constexpr double hardly_less = 1 - 1e-9;

void require(bool ok, const std::string& what) {
  if (!ok) throw Error(ErrorKind::usage, "surface detail: " + what);
}

void check(const DetailSettings& s, double diagonal) {
  const auto length = [&](double value, const char* name) {
    require(std::isfinite(value) && value > diagonal / finest_grid,
            std::string(name) + " must be a length that is not tiny compared to the body");
  };
  length(s.edge_length, "edge_length");
  length(s.line_step, "line_step");
  length(s.line_length, "line_length");
  length(s.influence_radius, "influence_radius");
  length(s.grid_spacing, "grid_spacing");
  require(std::isfinite(s.height) && s.height >= 0, "height must not be negative");
  require(s.longest_share >= 0 && s.longest_share <= 1, "longest_share must be in [0, 1]");
  require(s.grain >= 0 && s.grain <= 1, "grain must be in [0, 1]");
  if (s.grain > 0) length(s.grain_size, "grain_size");
}

void check(const geometry::RegionBoundary& regions, const Box& body, const DamageTimes& times) {
  const auto fail = [](const std::string& what) { throw Error(ErrorKind::internal, "surface detail: " + what); };
  if (body.isEmpty() || !(body.diagonal().norm() > 0)) fail("the body is empty");
  if (times.points.size() != times.time.size())
    fail(std::to_string(times.points.size()) + " points but " + std::to_string(times.time.size()) + " times");
  if (!times.points.empty() && !(times.spacing > 0)) fail("the spacing of the points must be positive");
  for (const auto& face : regions.faces) {
    if (face.loop.size() < 3) fail("a face has fewer than three corners");
    for (int v : face.loop)
      if (v < 0 || v >= static_cast<int>(regions.vertices.size())) fail("a face has a corner that does not exist");
  }
  for (std::size_t p = 0; p < times.points.size(); ++p)
    if (times.time[p] >= 0 && !(times.points[p].allFinite() && std::isfinite(times.time[p])))
      fail("point " + std::to_string(p) + " is not finite");
}

Box enlarged(const Box& box, double by) { return {box.min() - Vec3::Constant(by), box.max() + Vec3::Constant(by)}; }

/// What is the same for all vertices.
struct Plan {
  double height = 0;  // settings.height, or what the body's size allows
  Box refined;        // edges are short in it
  Box movable;        // vertices may move in it: heights are full on the body's box
};

Plan plan_of(const Box& body, const DetailSettings& settings) {
  const double diagonal = body.diagonal().norm();
  Plan plan;
  plan.height = std::min(settings.height, largest_share * diagonal);
  const double margin = std::min(2 * plan.height + settings.edge_length, largest_share * diagonal);
  plan.movable = enlarged(body, margin);
  plan.refined = enlarged(body, margin);
  return plan;
}

std::vector<double> wanted_heights(const FineMesh& mesh, const Sheets& sheets, const DetailSettings& settings,
                                   std::vector<double> perturbation) {
  for (std::size_t v = 0; v < perturbation.size(); ++v) {
    if (sheets.of_vertex[v] < 0) continue;
    const double line = std::tanh(perturbation[v]);
    const double grain = settings.grain > 0 ? grain_at(mesh.vertices[v], settings.grain_size, settings.seed) : 0;
    perturbation[v] = (1 - settings.grain) * line + settings.grain * grain;
  }
  return perturbation;
}

struct Marks {
  SurfaceField field;
  std::vector<double> share;  // per vertex, of the height, in [0, 1]
  int lines = 0, raised = 0;
};

Marks marks_of(const FineMesh& mesh, const Sheets& sheets, const Plan& plan, const DamageTimes& times,
               const DetailSettings& settings, Progress& progress) {
  const std::vector<std::vector<int>> vertices = vertices_by_sheet(sheets);
  std::vector<SheetGrid> grids;
  grids.reserve(vertices.size());
  for (const std::vector<int>& list : vertices) grids.emplace_back(mesh.vertices, list, settings.grid_spacing);
  Marks marks;
  marks.field.normal = sheet_normals(mesh, sheets, vertices, grids);
  progress.checkpoint("detail", 0.3);
  const TimeField field(times.points, times.time, std::max(settings.grid_spacing, time_grid * times.spacing));
  add_times(mesh, sheets, field, plan.refined, marks.field);
  progress.checkpoint("detail", 0.4);
  std::vector<Chevron> lines = trace_lines(
      mesh, sheets, marks.field, {settings.line_step, settings.line_length, settings.influence_radius}, progress);
  marks.lines = static_cast<int>(lines.size());
  lines = longest(std::move(lines), settings.longest_share);
  marks.raised = static_cast<int>(lines.size());
  marks.share =
      wanted_heights(mesh, sheets, settings, smear(mesh, sheets, vertices, grids, lines, settings.grid_spacing));
  return marks;
}

geometry::RegionBoundary boundary_of(const geometry::RegionBoundary& regions, const FineMesh& mesh,
                                     std::vector<Vec3> vertices) {
  geometry::RegionBoundary boundary;
  boundary.region_count = regions.region_count;
  boundary.vertices = std::move(vertices);
  boundary.faces.reserve(mesh.faces.size());
  for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
    const auto& face = regions.faces[mesh.source[f]];
    boundary.faces.push_back({{mesh.faces[f].begin(), mesh.faces[f].end()}, face.inside, face.outside});
  }
  return boundary;
}

}  // namespace

DetailedBoundary add_surface_detail(const geometry::RegionBoundary& regions, const Box& body, const DamageTimes& times,
                                    const DetailSettings& settings, Progress& progress) {
  check(regions, body, times);
  check(settings, body.diagonal().norm());
  const Plan plan = plan_of(body, settings);
  FineMesh mesh = triangulated(regions);
  refine(mesh, {plan.refined, settings.edge_length, growth_outside}, most_triangles, progress);
  const Sheets sheets = find_sheets(regions, mesh, plan.movable);
  progress.checkpoint("detail", 0.2);

  const Marks marks = marks_of(mesh, sheets, plan, times, settings, progress);
  std::vector<double> heights = clearance(mesh, sheets, marks.field.normal, plan.height, settings.edge_length);
  for (std::size_t v = 0; v < heights.size(); ++v) heights[v] *= marks.share[v];
  progress.checkpoint("detail", 0.7);
  Relief relief = displaced(mesh, sheets, marks.field.normal, std::move(heights), progress);

  DetailedBoundary result;
  for (std::size_t v = 0; v < relief.height.size(); ++v) {
    result.limited += relief.height[v] < hardly_less * settings.height * marks.share[v];
    result.largest_height = std::max(result.largest_height, relief.height[v]);
  }
  result.lowered = relief.lowered;
  result.lines = marks.lines;
  result.raised_lines = marks.raised;
  result.boundary = boundary_of(regions, mesh, std::move(relief.vertices));
  result.source_face = std::move(mesh.source);
  result.damage_time = marks.field.time;
  progress.report("detail", 1);
  return result;
}

}  // namespace sunder::crack
