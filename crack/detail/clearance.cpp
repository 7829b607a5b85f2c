#include "crack/detail/clearance.h"

#include <cmath>
#include <queue>

namespace sunder::crack::detail {

namespace {

constexpr double share_of_distance = 0.4;
constexpr double slope_from_fixed = 0.5;
constexpr int patches_per_cell = 4;  // along an axis

/// Vertices of one sheet, close to each other and facing the same of six ways.
struct Patch {
  GridCell cell;  // coarse
  int sheet = 0;
  Box box;
  Vec3 normal = Vec3::Zero();  // not of unit length
  std::vector<int> vertices;
};

std::uint64_t facing(const Vec3& normal) {
  int axis = 0;
  normal.cwiseAbs().maxCoeff(&axis);
  return static_cast<std::uint64_t>(2 * axis + (normal[axis] < 0));
}

/// By fine cell, then by sheet and facing.
std::vector<Patch> patches_of(const FineMesh& mesh, const Sheets& sheets, const std::vector<Vec3>& normals,
                              double fine) {
  IndexTable cells(mesh.vertices.size() / 4), patches_table(mesh.vertices.size() / 4);
  std::vector<Patch> patches;
  for (int v = 0; v < static_cast<int>(mesh.vertices.size()); ++v) {
    const int sheet = sheets.of_vertex[v];
    if (sheet < 0) continue;
    const GridCell cell = cell_of(mesh.vertices[v], fine);
    const auto number = static_cast<std::uint64_t>(cells.insert(cell_key(cell)));
    const std::uint64_t key = number << 32 | (static_cast<std::uint64_t>(sheet) * 6 + facing(normals[v]));
    const int p = patches_table.insert(key);
    if (p == static_cast<int>(patches.size())) {
      patches.emplace_back();
      patches[p].cell = cell_of(cell.cast<double>() + Vec3::Constant(0.5), patches_per_cell);
      patches[p].sheet = sheet;
    }
    patches[p].box.extend(mesh.vertices[v]);
    patches[p].normal += normals[v];
    patches[p].vertices.push_back(v);
  }
  return patches;
}

/// Patches by coarse cell.
class CoarseCells {
 public:
  explicit CoarseCells(const std::vector<Patch>& patches) {
    for (int p = 0; p < static_cast<int>(patches.size()); ++p) {
      const int c = table_.insert(cell_key(patches[p].cell));
      if (c == static_cast<int>(lists_.size())) lists_.emplace_back();
      lists_[c].push_back(p);
    }
  }

  /// All patches at most `reach` cells away; remembers the last answer.
  const std::vector<int>& around(const GridCell& cell, int reach) {
    if (reach == last_reach_ && cell == last_) return found_;
    last_reach_ = reach;
    last_ = cell;
    found_.clear();
    for (int i = -reach; i <= reach; ++i)
      for (int j = -reach; j <= reach; ++j)
        for (int k = -reach; k <= reach; ++k) {
          const int c = table_.find(cell_key(cell + GridCell(i, j, k)));
          if (c >= 0) found_.insert(found_.end(), lists_[c].begin(), lists_[c].end());
        }
    return found_;
  }

 private:
  IndexTable table_;
  std::vector<std::vector<int>> lists_;
  int last_reach_ = -1;
  GridCell last_ = GridCell::Zero();
  std::vector<int> found_;
};

struct Facing {
  double distance;
  int patch;
  bool operator<(const Facing& other) const {
    return distance != other.distance ? distance < other.distance : patch < other.patch;
  }
};

/// Patches of other sheets, and such that face the patch, up to a distance; nearest first.
void find_facing(const std::vector<Patch>& patches, int p, const std::vector<int>& around, double reach,
                 std::vector<Facing>& result) {
  result.clear();
  for (int q : around) {
    if (patches[p].sheet == patches[q].sheet && patches[p].normal.dot(patches[q].normal) >= 0) continue;
    const double squared = patches[p].box.squaredExteriorDistance(patches[q].box);
    if (squared < reach * reach) result.push_back({std::sqrt(squared), q});
  }
  std::sort(result.begin(), result.end());
}

void limit_by_distance(const FineMesh& mesh, const std::vector<Patch>& patches, double coarse,
                       std::vector<double>& values) {
  CoarseCells cells(patches);
  std::vector<int> order(patches.size());
  for (int p = 0; p < static_cast<int>(order.size()); ++p) order[p] = p;
  std::sort(order.begin(), order.end(), [&](int a, int b) {
    const std::uint64_t ka = cell_key(patches[a].cell), kb = cell_key(patches[b].cell);
    return ka != kb ? ka < kb : a < b;
  });
  std::vector<Facing> facing;
  for (int p : order) {
    double highest = 0;
    for (int v : patches[p].vertices) highest = std::max(highest, values[v]);
    const double reach = highest / share_of_distance;
    find_facing(patches, p, cells.around(patches[p].cell, static_cast<int>(std::ceil(reach / coarse))), reach, facing);
    for (const Facing& other : facing) {
      if (share_of_distance * other.distance >= highest) break;
      highest = 0;
      for (int v : patches[p].vertices) {
        const double bound = share_of_distance * patches[other.patch].box.exteriorDistance(mesh.vertices[v]);
        highest = std::max(highest, values[v] = std::min(values[v], bound));
      }
    }
  }
}

}  // namespace

void limit_slope(const FineMesh& mesh, const EdgeGraph& edges, double slope, std::vector<double>& values) {
  using Entry = std::pair<double, int>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
  const auto lower_around = [&](int v) {
    for (int e = edges.start[v]; e < edges.start[v + 1]; ++e) {
      const int u = edges.neighbour[e];
      if (values[u] <= values[v]) continue;
      const double bound = values[v] + slope * (mesh.vertices[u] - mesh.vertices[v]).norm();
      if (values[u] <= bound) continue;
      values[u] = bound;
      queue.push({bound, u});
    }
  };
  for (int v = 0; v < static_cast<int>(values.size()); ++v) lower_around(v);
  while (!queue.empty()) {
    const auto [value, v] = queue.top();
    queue.pop();
    if (value == values[v]) lower_around(v);
  }
}

std::vector<double> clearance(const FineMesh& mesh, const Sheets& sheets, const std::vector<Vec3>& normals, double most,
                              double edge_length) {
  std::vector<double> values(mesh.vertices.size(), 0);
  for (std::size_t v = 0; v < values.size(); ++v)
    if (sheets.of_vertex[v] >= 0) values[v] = most;
  const double reach = most / share_of_distance;
  const double fine = std::max(reach / (2 * patches_per_cell), edge_length);
  limit_slope(mesh, sheets.edges, slope_from_fixed, values);  // before, so that fewer distances are asked for
  limit_by_distance(mesh, patches_of(mesh, sheets, normals, fine), patches_per_cell * fine, values);
  limit_slope(mesh, sheets.edges, slope_from_fixed, values);
  return values;
}

}  // namespace sunder::crack::detail
