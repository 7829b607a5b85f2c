/// The second velocity field of a continuum: which nodes belong to both sides of a crack, and which particles to which.
#include <algorithm>
#include <cmath>

#include <tbb/parallel_for.h>

#include "mpm/continuum.h"

namespace sunder::mpm {
namespace {

/// A crack further from a node than the corner of its stencil divides none of its particles. Fan (2024) 3.4.1
/// prints 1.5 h, which a crack oblique to the grid passes by.
double furthest_plane(Spline spline) { return 0.5 * stencil_width(spline) * std::sqrt(3.0); }
/// The closest face must lie beside the node: beyond the rim of a crack its plane divides nothing. Faces are about half
/// a cell apart [cells].
constexpr double widest_gap = 0.75;

}  // namespace

void Continuum::open(const std::vector<CrackFace>& faces, double friction) {
  if (faces.empty()) return;
  friction_ = friction;
  cracked_ = true;
  FaceBins fresh = faces_.emptied();
  for (const CrackFace& face : faces) {
    faces_.bin(face.position).push_back(face);
    fresh.bin(face.position).push_back(face);
  }
  if (sorted_) divide(fresh);
}

/// Planes and sides anew where these faces reach.
void Continuum::divide(const FaceBins& near) {
  std::vector<bool> changed(blocks_.size(), false);
  find_planes(near, changed);
  find_sides(changed);
  if (&near == &faces_) steps_since_division_ = 0;
}

/// Unit normal of the plane of the closest face, and its offset along it; zero without one.
Node Continuum::plane_at(const Vec3& x) const {
  const double h = settings_.cell_size, reach = furthest_plane(settings_.spline) * h;
  double nearest = reach * reach;
  const CrackFace* closest = nullptr;
  FaceBins::visit(faces_, x, reach, [&](const std::vector<CrackFace>& faces) {
    for (const CrackFace& face : faces)
      if (const double d = (x - face.position).squaredNorm(); d < nearest) {
        nearest = d;
        closest = &face;
      }
    return false;
  });
  if (!closest) return {};
  const double off_plane = (x - closest->position).dot(closest->normal);
  if (nearest - off_plane * off_plane > widest_gap * widest_gap * h * h) return {};
  const Vec3& n = closest->normal;
  return {{n[0], n[1], n[2], n.dot(closest->position)}};
}

Vec3 Continuum::mean_displacement(const Block& block) const {
  Vec3 sum = Vec3::Zero();
  for (int n = 0; n < block.count; ++n)
    for (int a = 0; a < 3; ++a)
      sum[a] += chunks_[static_cast<std::size_t>(block.first_chunk + n / chunk_size)].displacement[a][n % chunk_size];
  return sum / std::max(1, block.count);
}

void Continuum::add_planes(int block) {
  blocks_[static_cast<std::size_t>(block)].planes = static_cast<int>(planes_.size()) / block_nodes;
  planes_.resize(planes_.size() + block_nodes, Node{});
  // Until now the two fields moved as one.
  const auto first = nodes_.begin() + static_cast<std::ptrdiff_t>(block) * block_nodes;
  second_nodes_.insert(second_nodes_.end(), first, first + block_nodes);
  for (std::size_t n = second_nodes_.size() - block_nodes; n < second_nodes_.size(); ++n) second_nodes_[n].value[3] = 0;
}

/// Nodes are fixed in space, faces in the material: the displacement of the particles around brings them together.
void Continuum::find_planes(const FaceBins& near, std::vector<bool>& changed) {
  const Vec3 origin(constants_.origin[0], constants_.origin[1], constants_.origin[2]);
  struct Planes {
    bool looked = false, any = false;
    std::array<Node, block_nodes> plane = {};
  };
  std::vector<Planes> found(blocks_.size());
  tbb::parallel_for(std::size_t{0}, blocks_.size(), [&](std::size_t b) {
    const std::array<int, 3> at = blocks_[b].at;
    const Block* moving = nullptr;
    for (int n = 0; n < 8 && !moving; ++n) {
      const int below = find_block({at[0] - (n >> 2), at[1] - (n >> 1 & 1), at[2] - (n & 1)});
      if (below >= 0 && below < holding_) moving = &blocks_[static_cast<std::size_t>(below)];
    }
    if (!moving) return;
    const Vec3 shift = origin - mean_displacement(*moving);
    const auto node = [&](int i, int j, int k) -> Vec3 {
      return shift +
             constants_.cell_size * Vec3(block_edge * at[0] + i, block_edge * at[1] + j, block_edge * at[2] + k);
    };
    if (!faces_near(near, node(0, 0, 0), node(block_edge - 1, block_edge - 1, block_edge - 1))) return;
    found[b].looked = true;
    for (int n = 0; n < block_nodes; ++n) {
      const Node plane = plane_at(node(n / 16, n / 4 % 4, n % 4));
      found[b].any = found[b].any || plane.value[0] != 0 || plane.value[1] != 0 || plane.value[2] != 0;
      found[b].plane[static_cast<std::size_t>(n)] = plane;
    }
  });
  for (std::size_t b = 0; b < blocks_.size(); ++b) {
    if (!found[b].looked) continue;
    changed[b] = true;
    if (found[b].any && blocks_[b].planes < 0) add_planes(static_cast<int>(b));
    if (blocks_[b].planes < 0) continue;
    std::copy(found[b].plane.begin(), found[b].plane.end(),
              planes_.begin() + static_cast<std::ptrdiff_t>(blocks_[b].planes) * block_nodes);
  }
}

/// Some face within the reach of a stencil of a box of nodes.
bool Continuum::faces_near(const FaceBins& faces, const Vec3& low, const Vec3& high) const {
  const double reach = furthest_plane(settings_.spline) * settings_.cell_size + 0.5 * (high - low).norm();
  bool found = false;
  FaceBins::visit(faces, 0.5 * (low + high), reach,
                  [&](const std::vector<CrackFace>& bin) { return found = !bin.empty(); });
  return found;
}

bool Continuum::behind(int block, int local, const Vec3& x) const {
  const int planes = blocks_[static_cast<std::size_t>(block)].planes;
  if (planes < 0) return false;
  const std::size_t node = static_cast<std::size_t>(planes * block_nodes + local);
  const double* plane = planes_[node].value;
  return plane[0] * x[0] + plane[1] * x[1] + plane[2] * x[2] < plane[3];
}

unsigned long long Continuum::sides(const int cell[3], const Vec3& material_position) const {
  const int width = stencil_width(settings_.spline);
  unsigned long long result = 0;
  int bit = 0;
  for (int i = 0; i < width; ++i)
    for (int j = 0; j < width; ++j)
      for (int k = 0; k < width; ++k, ++bit) {
        const auto [block, local] = find_node({cell[0] + i, cell[1] + j, cell[2] + k});
        if (block >= 0 && behind(block, local, material_position)) result |= 1ull << bit;
      }
  return result;
}

/// Particles are classified when they next ask; here only where they have to, and which blocks need a second tile.
void Continuum::find_sides(const std::vector<bool>& changed) {
  const std::size_t tile_size = static_cast<std::size_t>(tile_nodes(settings_.spline));
  for (int b = 0; b < holding_; ++b) {
    Block& block = blocks_[static_cast<std::size_t>(b)];
    bool divided = false, ask = false;
    for (int n = 0; n < 8; ++n) {
      const int above = find_block({block.at[0] + (n >> 2), block.at[1] + (n >> 1 & 1), block.at[2] + (n & 1)});
      if (above < 0) continue;
      divided = divided || blocks_[static_cast<std::size_t>(above)].planes >= 0;
      ask = ask || changed[static_cast<std::size_t>(above)];
    }
    if (divided && block.second_tile < 0) {
      block.second_tile = static_cast<int>(second_tiles_.size() / tile_size);
      second_tiles_.resize(second_tiles_.size() + tile_size);
    }
    if (!ask) continue;
    for (int n = 0; n < block.count; ++n)
      chunks_[static_cast<std::size_t>(block.first_chunk + n / chunk_size)].side_corner[n % chunk_size] = -1;
  }
}

}  // namespace sunder::mpm
