#include "crack/detail/cells.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <unordered_map>

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>
#include <voro++/voro++.hh>

#include "core/random.h"

namespace sunder::crack::detail {

namespace {

constexpr double block_width = 3;    // in units; 2 to 4 differ by less than the noise of the measurement
constexpr double most_blocks = 200;  // along an axis
constexpr int smallest_share = 500;  // sites per thread: a thread needs all sites sorted into blocks of its own

/// The four cells or walls that meet at a vertex, ascending.
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

/// A face as one of its two cells sees it.
struct SeenFace {
  int site = 0, neighbour = 0;
  bool inner = false;
  int first = 0, count = 0;  // its corners
};

/// The wanted faces of some cells.
struct SeenFaces {
  std::vector<SeenFace> faces;
  std::vector<VertexKey> keys;  // of the corners, counter-clockwise seen from the neighbour
  std::vector<Vec3> positions;
  bool usable = true;
};

class Watcher {
 public:
  Watcher(const std::vector<Site>& sites, const CellRequest& request, const Frame& frame)
      : sites_(sites), request_(request), frame_(frame) {}

  void add(int site, voro::voronoicell_neighbor& cell) {
    if (!wants_any(site, cell)) return;
    const Vec3 centre = frame_.local(sites_[site].position);
    cell.neighbors(neighbours_);
    cell.face_vertices(loops_);
    cell.vertices(centre.x(), centre.y(), centre.z(), corners_);
    for (std::size_t face = 0, at = 0; face < neighbours_.size(); at += loops_[at] + 1, ++face) {
      const int neighbour = neighbours_[face];
      const bool inner = wants_inner(site, neighbour);
      if (inner || wants_between(site, neighbour))
        add_face({site, neighbour, inner}, cell, &loops_[at + 1], loops_[at]);
    }
  }

  SeenFaces finish() { return std::move(result_); }
  void fail() { result_.usable = false; }

 private:
  bool wants_between(int site, int neighbour) const {
    if (!request_.pieces) return false;
    return neighbour < 0 || sites_[site].piece != sites_[neighbour].piece;
  }

  bool wants_inner(int site, int neighbour) const {
    if (neighbour <= site || sites_[site].piece != sites_[neighbour].piece) return false;
    if (!sites_[site].is_border || !sites_[neighbour].is_border) return false;
    return (sites_[site].position - sites_[neighbour].position).norm() > request_.inner_distance;
  }

  bool wants_any(int site, const voro::voronoicell_neighbor& cell) const {
    for (int v = 0; v < cell.p; ++v)
      for (int e = 0; e < cell.nu[v]; ++e)
        if (wants_between(site, cell.ne[v][e]) || wants_inner(site, cell.ne[v][e])) return true;
    return false;
  }

  void add_face(SeenFace face, const voro::voronoicell_neighbor& cell, const int* loop, int count) {
    face.first = static_cast<int>(result_.keys.size());
    face.count = count;
    for (int i = count - 1; i >= 0; --i) {  // Voro++ goes clockwise as seen from outside the cell
      const int v = loop[i];
      if (cell.nu[v] != 3) return fail();
      VertexKey key = {face.site, cell.ne[v][0], cell.ne[v][1], cell.ne[v][2]};
      std::sort(key.begin(), key.end());
      result_.keys.push_back(key);
      result_.positions.push_back(frame_.world({corners_[3 * v], corners_[3 * v + 1], corners_[3 * v + 2]}));
    }
    result_.faces.push_back(face);
  }

  const std::vector<Site>& sites_;
  const CellRequest& request_;
  const Frame& frame_;
  SeenFaces result_;
  std::vector<int> neighbours_, loops_;
  std::vector<double> corners_;
};

/// The cells of sites `first` to `last`, in a container of all sites.
SeenFaces watch(const std::vector<Site>& sites, int first, int last, const CellRequest& request) {
  const Frame frame{request.box.center(), request.unit};
  voro::container container = make_container(request.box, frame);
  voro::particle_order own;
  for (int i = 0; i < static_cast<int>(sites.size()); ++i) {
    const Vec3 x = frame.local(sites[i].position);
    if (i >= first && i < last)
      container.put(own, i, x.x(), x.y(), x.z());
    else
      container.put(i, x.x(), x.y(), x.z());
  }
  Watcher watcher(sites, request, frame);
  voro::c_loop_order loop(container, own);
  voro::voronoicell_neighbor cell;
  if (loop.start()) do {
      if (container.compute_cell(cell, loop))
        watcher.add(loop.pid(), cell);
      else
        watcher.fail();
    } while (loop.inc());
  return watcher.finish();
}

/// Gives corners their numbers and checks that both cells of a face see the same.
class Collector {
 public:
  explicit Collector(const CellRequest& request) : request_(request) {}

  /// False if a face cannot be used.
  bool add(const SeenFaces& seen) {
    if (!seen.usable) return false;
    for (const SeenFace& face : seen.faces)
      if (!add(face, seen)) return false;
    return true;
  }

  std::optional<CellFaces> finish() {
    const auto order = [](const CellFace& a, const CellFace& b) {
      return std::pair(a.site, a.neighbour) < std::pair(b.site, b.neighbour);
    };
    std::sort(result_.faces.begin(), result_.faces.end(), order);
    std::sort(result_.inner.begin(), result_.inner.end(), order);
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
  bool add(const SeenFace& seen, const SeenFaces& all) {
    CellFace face{seen.site, seen.neighbour, {}};
    for (int i = seen.first; i < seen.first + seen.count; ++i)
      face.loop.push_back(vertex(all.keys[i], all.positions[i]));
    if (seen.inner) {
      result_.inner.push_back(std::move(face));
      return true;
    }
    if (!well_formed(face.loop)) return false;
    const bool mirrored = face.neighbour >= 0 && face.neighbour < face.site;
    if (mirrored) {
      std::swap(face.site, face.neighbour);
      std::reverse(face.loop.begin(), face.loop.end());
    }
    std::rotate(face.loop.begin(), std::min_element(face.loop.begin(), face.loop.end()), face.loop.end());
    (mirrored ? mirrored_ : result_.faces).push_back(std::move(face));
    return true;
  }

  int vertex(const VertexKey& key, const Vec3& position) {
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

  const CellRequest& request_;
  CellFaces result_;
  std::vector<CellFace> mirrored_;  // as seen from the higher site, turned round
  std::unordered_map<VertexKey, int, KeyHash> ids_;
};

}  // namespace

std::optional<CellFaces> cell_faces(const std::vector<Site>& sites, const CellRequest& request) {
  const int count = static_cast<int>(sites.size());
  const int shares = std::clamp(count / smallest_share, 1, tbb::this_task_arena::max_concurrency());
  std::vector<SeenFaces> seen(static_cast<std::size_t>(shares));
  const auto first = [&](int share) { return static_cast<int>(static_cast<long>(count) * share / shares); };
  tbb::parallel_for(0, shares, [&](int share) {
    seen[static_cast<std::size_t>(share)] = watch(sites, first(share), first(share + 1), request);
  });
  Collector collector(request);
  for (const SeenFaces& share : seen)
    if (!collector.add(share)) return {};
  return collector.finish();
}

}  // namespace sunder::crack::detail
