#include "crack/detail/chevrons.h"

#include <cmath>

namespace sunder::crack::detail {

namespace {

constexpr double samples_per_cell = 2;  // of a line while it is smeared

/// Vertices by the cell of a grid that they lie in.
class VertexCells {
 public:
  VertexCells(const std::vector<Vec3>& positions, const std::vector<int>& vertices, double width) : width_(width) {
    std::vector<int> cell;
    cell.reserve(vertices.size());
    for (int v : vertices) cell.push_back(table_.insert(cell_key(cell_of(positions[v], width))));
    start_.assign(table_.size() + 1, 0);
    for (int c : cell) ++start_[c + 1];
    for (int c = 0; c < table_.size(); ++c) start_[c + 1] += start_[c];
    entries_.resize(vertices.size());
    std::vector<int> at(start_.begin(), start_.end() - 1);
    for (std::size_t i = 0; i < vertices.size(); ++i) entries_[at[cell[i]]++] = vertices[i];
  }

  /// Calls visit(vertex) for the vertices in all cells that a ball touches, and may be more.
  template <typename Visit>
  void for_each_near(const Vec3& x, double radius, Visit&& visit) const {
    const GridCell low = cell_of(x - Vec3::Constant(radius), width_),
                   high = cell_of(x + Vec3::Constant(radius), width_);
    for (int i = low.x(); i <= high.x(); ++i)
      for (int j = low.y(); j <= high.y(); ++j)
        for (int k = low.z(); k <= high.z(); ++k) {
          const int c = table_.find(cell_key(GridCell(i, j, k)));
          if (c < 0) continue;
          for (int e = start_[c]; e < start_[c + 1]; ++e) visit(entries_[e]);
        }
  }

 private:
  double width_;
  IndexTable table_;
  std::vector<int> start_, entries_;
};

class Tracer {
 public:
  Tracer(const FineMesh& mesh, const Sheets& sheets, const SurfaceField& field, const LineSettings& settings,
         const std::vector<int>& vertices)
      : x_(mesh.vertices),
        sheet_(sheets.of_vertex),
        field_(field),
        settings_(settings),
        cells_(mesh.vertices, vertices, std::max(settings.step, settings.radius)),
        visited_(mesh.vertices.size(), 0) {}

  bool visited(int v) const { return visited_[v]; }

  Chevron trace(int start) {
    Chevron line{{start}, 0};
    visit_beside(start);
    for (int v = start; line.length < settings_.length;) {
      const int next = step_from(v);
      if (next < 0) break;
      line.length += (x_[next] - x_[v]).norm();
      line.vertices.push_back(next);
      visit_beside(next);
      v = next;
    }
    return line;
  }

 private:
  int step_from(int v) const {
    if (field_.direction[v].isZero()) return -1;
    const Vec3 target = x_[v] + settings_.step * field_.direction[v];
    int best = -1;
    double nearest = settings_.step * settings_.step / 4;
    cells_.for_each_near(target, settings_.step / 2, [&](int u) {
      if (visited_[u] || !same_side(v, u)) return;
      const double squared = (x_[u] - target).squaredNorm();
      if (squared < nearest || (squared == nearest && u < best)) nearest = squared, best = u;
    });
    return best;
  }

  void visit_beside(int v) {
    visited_[v] = 1;
    const Vec3 along = field_.direction[v], across = along.cross(field_.normal[v]);
    const double half = settings_.step / 2;
    if (along.isZero()) return;
    cells_.for_each_near(x_[v], std::hypot(half, settings_.radius), [&](int u) {
      const Vec3 r = x_[u] - x_[v];
      if (std::abs(r.dot(along)) <= half && std::abs(r.dot(across)) <= settings_.radius &&
          std::abs(r.dot(field_.normal[v])) <= settings_.radius && same_side(v, u))
        visited_[u] = 1;
    });
  }

  bool same_side(int v, int u) const { return sheet_[u] == sheet_[v] && field_.normal[u].dot(field_.normal[v]) > 0; }

  const std::vector<Vec3>& x_;
  const std::vector<int>& sheet_;
  const SurfaceField& field_;
  const LineSettings& settings_;
  VertexCells cells_;
  std::vector<char> visited_;
};

}  // namespace

std::vector<Chevron> trace_lines(const FineMesh& mesh, const Sheets& sheets, const SurfaceField& field,
                                 const LineSettings& settings, Progress& progress) {
  std::vector<int> order;
  for (int v = 0; v < static_cast<int>(mesh.vertices.size()); ++v)
    if (sheets.of_vertex[v] >= 0 && !field.direction[v].isZero()) order.push_back(v);
  Tracer tracer(mesh, sheets, field, settings, order);
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return field.time[a] < field.time[b]; });
  std::vector<Chevron> lines;
  for (int start : order) {
    if (tracer.visited(start)) continue;
    Chevron line = tracer.trace(start);
    if (line.vertices.size() > 1) lines.push_back(std::move(line));
  }
  progress.checkpoint("detail", 0.5);
  return lines;
}

std::vector<Chevron> longest(std::vector<Chevron> lines, double share) {
  std::stable_sort(lines.begin(), lines.end(), [](const Chevron& a, const Chevron& b) {
    return a.length != b.length ? a.length > b.length : a.vertices.front() < b.vertices.front();
  });
  lines.resize(static_cast<std::size_t>(std::ceil(share * static_cast<double>(lines.size()))));
  return lines;
}

std::vector<double> smear(const FineMesh& mesh, const Sheets& sheets, const std::vector<std::vector<int>>& vertices,
                          const std::vector<SheetGrid>& grids, const std::vector<Chevron>& lines, double spacing) {
  std::vector<std::vector<double>> nodes(grids.size());
  for (std::size_t s = 0; s < grids.size(); ++s) nodes[s].assign(grids[s].node_count(), 0);
  for (const Chevron& line : lines) {
    const int s = sheets.of_vertex[line.vertices.front()];
    double way = 0;
    for (std::size_t i = 1; i < line.vertices.size(); ++i) {
      const Vec3 &a = mesh.vertices[line.vertices[i - 1]], &b = mesh.vertices[line.vertices[i]];
      const double length = (b - a).norm();
      const int parts = std::max(1, static_cast<int>(std::ceil(samples_per_cell * length / spacing)));
      for (int p = 0; p < parts; ++p) {
        const double t = (p + 0.5) / parts;
        const double value = 1 + (way + t * length) / line.length;
        grids[s].deposit(Vec3(a + t * (b - a)), value * length / (parts * spacing), nodes[s]);
      }
      way += length;
    }
  }
  std::vector<double> result(mesh.vertices.size(), 0);
  for (std::size_t s = 0; s < grids.size(); ++s)
    for (std::size_t i = 0; i < vertices[s].size(); ++i) result[vertices[s][i]] = grids[s].gather(i, nodes[s], 0.0);
  return result;
}

}  // namespace sunder::crack::detail
