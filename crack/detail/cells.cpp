#include "crack/detail/cells.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <unordered_map>

#include <voro++/voro++.hh>

#include "core/random.h"

namespace sunder::crack::detail {

namespace {

constexpr double block_width = 3;    // in units; measured: best for plates, within a fifth of the best for cubes
constexpr double most_blocks = 200;  // along an axis

using VertexKey = std::array<int, 4>;

struct KeyHash {
  std::size_t operator()(const VertexKey& key) const {
    std::uint64_t h = 0;
    for (int part : key) h = mix(h ^ static_cast<std::uint32_t>(part));
    return h;
  }
};

/// Space in units about the middle of the box.
struct Frame {
  Vec3 centre;
  double unit;
  Vec3 local(const Vec3& x) const { return (x - centre) / unit; }
  Vec3 world(const Vec3& x) const { return centre + unit * x; }
};

int blocks(double extent) { return static_cast<int>(std::clamp(std::ceil(extent / block_width), 1.0, most_blocks)); }

voro::container make_container(const Box& box, const Frame& frame) {
  const Vec3 low = frame.local(box.min()), high = frame.local(box.max()), size = high - low;
  return voro::container(low.x(), high.x(), low.y(), high.y(), low.z(), high.z(), blocks(size.x()), blocks(size.y()),
                         blocks(size.z()), false, false, false, 4);
}

/// Takes cells in the order of their sites and keeps the wanted faces.
class Collector {
 public:
  Collector(const std::vector<Site>& sites, const CellRequest& request, const Frame& frame)
      : sites_(sites), request_(request), frame_(frame) {}

  /// False if the cell cannot be used.
  bool add(int site, voro::voronoicell_neighbor& cell) {
    if (!wants_any(site, cell)) return true;
    const Vec3 centre = frame_.local(sites_[site].position);
    cell.neighbors(neighbours_);
    cell.face_vertices(loops_);
    cell.vertices(centre.x(), centre.y(), centre.z(), corners_);
    for (std::size_t face = 0, at = 0; face < neighbours_.size(); at += loops_[at] + 1, ++face) {
      const int neighbour = neighbours_[face];
      const int* first = &loops_[at + 1];
      const int* last = first + loops_[at];
      if (wants_inner(site, neighbour)) add_inner(site, neighbour, first, last);
      if (wants_between(site, neighbour) && !add_between(site, neighbour, cell, first, last)) return false;
    }
    return true;
  }

  /// All faces between pieces, if both cells of every one see the same loop.
  std::optional<CellFaces> finish() {
    const auto order = [](const CellFace& a, const CellFace& b) {
      return std::pair(a.site, a.neighbour) < std::pair(b.site, b.neighbour);
    };
    std::sort(result_.faces.begin(), result_.faces.end(), order);
    std::sort(mirrored_.begin(), mirrored_.end(), order);
    auto other = mirrored_.begin();
    for (const CellFace& face : result_.faces) {
      if (face.neighbour < 0) continue;
      if (other == mirrored_.end() || other->site != face.site || other->neighbour != face.neighbour) return {};
      if (other->loop != face.loop) return {};
      ++other;
    }
    if (other != mirrored_.end()) return {};
    return std::move(result_);
  }

 private:
  bool wants_between(int site, int neighbour) const {
    if (!request_.pieces) return false;
    return neighbour < 0 || sites_[site].piece != sites_[neighbour].piece;
  }

  bool wants_inner(int site, int neighbour) const {
    if (neighbour <= site || sites_[site].piece != sites_[neighbour].piece) return false;
    return (sites_[site].position - sites_[neighbour].position).norm() > request_.inner_distance;
  }

  bool wants_any(int site, const voro::voronoicell_neighbor& cell) const {
    for (int v = 0; v < cell.p; ++v)
      for (int e = 0; e < cell.nu[v]; ++e)
        if (wants_between(site, cell.ne[v][e]) || wants_inner(site, cell.ne[v][e])) return true;
    return false;
  }

  Vec3 corner(int v) const { return frame_.world({corners_[3 * v], corners_[3 * v + 1], corners_[3 * v + 2]}); }

  void add_inner(int site, int neighbour, const int* first, const int* last) {
    InnerFace face{site, neighbour, {}};
    for (const int* v = last; v != first;) face.polygon.push_back(corner(*--v));
    result_.inner.push_back(std::move(face));
  }

  bool add_between(int site, int neighbour, const voro::voronoicell_neighbor& cell, const int* first, const int* last) {
    CellFace face{site, neighbour, {}};
    for (const int* v = first; v != last; ++v) {
      if (cell.nu[*v] != 3) return false;
      face.loop.push_back(vertex({site, cell.ne[*v][0], cell.ne[*v][1], cell.ne[*v][2]}, corner(*v)));
    }
    if (!well_formed(face.loop)) return false;
    const bool mirrored = neighbour >= 0 && neighbour < site;
    if (mirrored) std::swap(face.site, face.neighbour);
    // Voro++ goes clockwise as seen from outside the cell.
    if (!mirrored) std::reverse(face.loop.begin(), face.loop.end());
    std::rotate(face.loop.begin(), std::min_element(face.loop.begin(), face.loop.end()), face.loop.end());
    (mirrored ? mirrored_ : result_.faces).push_back(std::move(face));
    return true;
  }

  int vertex(VertexKey key, const Vec3& position) {
    std::sort(key.begin(), key.end());
    const auto [entry, is_new] = ids_.try_emplace(key, static_cast<int>(result_.vertices.size()));
    if (is_new) result_.vertices.push_back(position);
    return entry->second;
  }

  bool well_formed(const std::vector<int>& loop) const {
    if (loop.size() < 3) return false;
    for (std::size_t i = 0; i < loop.size(); ++i) {
      const Vec3& from = result_.vertices[loop[i]];
      const Vec3& to = result_.vertices[loop[(i + 1) % loop.size()]];
      if (!((to - from).norm() > request_.shortest_edge)) return false;
    }
    return true;
  }

  const std::vector<Site>& sites_;
  const CellRequest& request_;
  const Frame& frame_;
  CellFaces result_;
  std::vector<CellFace> mirrored_;  // as seen from the higher site, turned round
  std::unordered_map<VertexKey, int, KeyHash> ids_;
  std::vector<int> neighbours_, loops_;
  std::vector<double> corners_;
};

}  // namespace

std::optional<CellFaces> cell_faces(const std::vector<Site>& sites, const CellRequest& request) {
  const Frame frame{request.box.center(), request.unit};
  voro::container container = make_container(request.box, frame);
  voro::particle_order order;
  for (std::size_t i = 0; i < sites.size(); ++i) {
    const Vec3 x = frame.local(sites[i].position);
    container.put(order, static_cast<int>(i), x.x(), x.y(), x.z());
  }
  Collector collector(sites, request, frame);
  voro::c_loop_order loop(container, order);
  voro::voronoicell_neighbor cell;
  if (loop.start()) do {
      if (!container.compute_cell(cell, loop) || !collector.add(loop.pid(), cell)) return {};
    } while (loop.inc());
  return collector.finish();
}

}  // namespace sunder::crack::detail
