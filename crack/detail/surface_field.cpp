#include "crack/detail/surface_field.h"

#include <queue>
#include <tuple>

namespace sunder::crack::detail {

namespace {

constexpr double least_tangential = 0.2;  // share of the gradient that has to lie in the surface
constexpr double least_outward = 0.7;     // cosine between the normal and the direction in which nothing is known
constexpr double least_sum = 1e-3;        // of smoothed normals: less means that the sheet is folded back on itself

Vec3 unit_or_zero(const Vec3& v) {
  const double norm = v.norm();
  return norm > 0 ? Vec3(v / norm) : Vec3::Zero();
}

std::vector<Vec3> area_normals(const FineMesh& mesh, const Sheets& sheets) {
  std::vector<Vec3> normals(mesh.vertices.size(), Vec3::Zero());
  for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
    const auto& [a, b, c] = mesh.faces[f];
    Vec3 n = (mesh.vertices[b] - mesh.vertices[a]).cross(mesh.vertices[c] - mesh.vertices[a]);
    if (sheets.flipped[f]) n = -n;
    for (int v : mesh.faces[f])
      if (sheets.of_vertex[v] >= 0) normals[v] += n;
  }
  return normals;
}

Vec3 tangential(const Vec3& v, const Vec3& normal) { return v - normal * normal.dot(v); }

/// Does the sample say where the front ran in the surface?
bool runs_along(const TimeField::Sample& sample, const Vec3& normal) {
  const double steepness = sample.gradient.norm();
  const bool open_outward = sample.open.isZero() || std::abs(sample.open.dot(normal)) >= least_outward;
  return open_outward && steepness > 0 && tangential(sample.gradient, normal).norm() >= least_tangential * steepness;
}

/// The nearest known vertex along edges, per vertex: itself where known, -1 where there is none.
std::vector<int> nearest_known(const FineMesh& mesh, const Sheets& sheets, const std::vector<char>& known) {
  using Entry = std::tuple<double, int, int>;  // distance, vertex, where it comes from
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
  std::vector<int> source(known.size(), -1);
  const auto spread = [&](int v, double distance) {
    for (int e = sheets.edges.start[v]; e < sheets.edges.start[v + 1]; ++e) {
      const int u = sheets.edges.neighbour[e];
      if (source[u] < 0) queue.push({distance + (mesh.vertices[u] - mesh.vertices[v]).norm(), u, source[v]});
    }
  };
  for (int v = 0; v < static_cast<int>(known.size()); ++v)
    if (known[v]) source[v] = v;
  for (int v = 0; v < static_cast<int>(known.size()); ++v)
    if (known[v]) spread(v, 0);
  while (!queue.empty()) {
    const auto [distance, v, from] = queue.top();
    queue.pop();
    if (source[v] >= 0) continue;
    source[v] = from;
    spread(v, distance);
  }
  return source;
}

}  // namespace

std::vector<std::vector<int>> vertices_by_sheet(const Sheets& sheets) {
  std::vector<std::vector<int>> lists(sheets.count);
  for (int v = 0; v < static_cast<int>(sheets.of_vertex.size()); ++v)
    if (sheets.of_vertex[v] >= 0) lists[sheets.of_vertex[v]].push_back(v);
  return lists;
}

std::vector<Vec3> sheet_normals(const FineMesh& mesh, const Sheets& sheets,
                                const std::vector<std::vector<int>>& vertices, const std::vector<SheetGrid>& grids) {
  std::vector<Vec3> normals = area_normals(mesh, sheets);
  for (std::size_t s = 0; s < grids.size(); ++s) {
    const std::vector<int>& list = vertices[s];
    std::vector<Vec3> nodes(grids[s].node_count(), Vec3::Zero());
    double area = 0;
    for (std::size_t i = 0; i < list.size(); ++i) {
      grids[s].deposit_vertex(i, normals[list[i]], nodes);
      area += normals[list[i]].norm();
    }
    const double least = list.empty() ? 0 : least_sum * area / static_cast<double>(list.size());
    for (std::size_t i = 0; i < list.size(); ++i) {
      const Vec3 smooth = grids[s].gather(i, nodes, Vec3(Vec3::Zero()));
      normals[list[i]] = unit_or_zero(smooth.norm() > least ? smooth : normals[list[i]]);
    }
  }
  return normals;
}

void add_times(const FineMesh& mesh, const Sheets& sheets, const TimeField& times, const Box& box,
               SurfaceField& field) {
  const std::size_t n = mesh.vertices.size();
  field.time.assign(n, -1);
  field.direction.assign(n, Vec3::Zero());
  std::vector<Vec3> gradient(n, Vec3::Zero());
  std::vector<char> known(n, 0);
  for (std::size_t v = 0; v < n && !times.empty(); ++v) {
    if (!box.contains(mesh.vertices[v])) continue;
    const auto sample = times.at(mesh.vertices[v]);
    if (!sample) continue;
    known[v] = runs_along(*sample, field.normal[v]);
    field.time[v] = std::max(0.0, sample->time);
    gradient[v] = sample->gradient;
  }
  const std::vector<int> source = nearest_known(mesh, sheets, known);
  for (std::size_t v = 0; v < n; ++v) {
    const int from = source[v];
    if (from < 0 || !box.contains(mesh.vertices[v])) continue;
    if (field.time[v] < 0)
      field.time[v] = std::max(0.0, field.time[from] + gradient[from].dot(mesh.vertices[v] - mesh.vertices[from]));
    if (sheets.of_vertex[v] >= 0) field.direction[v] = unit_or_zero(tangential(gradient[from], field.normal[v]));
  }
}

}  // namespace sunder::crack::detail
