/// The grid of a continuum: a dense table of sparse blocks, sorted points, tiles, and nodes that are held.
#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/optional_effects.h"
#include "mpm/continuum.h"
#include "mpm/detail/point_access.h"

namespace sunder::mpm {

std::array<int, 3> Continuum::block_of(const Vec3& position) const {
  std::array<int, 3> block;
  for (int a = 0; a < 3; ++a) {
    const double cell = (position[a] - constants_.origin[a]) / constants_.cell_size - stencil_shift(settings_.spline);
    block[static_cast<std::size_t>(a)] = floor_div(static_cast<int>(std::floor(cell)), block_edge);
  }
  return block;
}

int Continuum::table_index(const std::array<int, 3>& block) const {
  int index = 0;
  for (std::size_t a = 0; a < 3; ++a) {
    const int at = block[a] - table_low_[a];
    if (at < 0 || at >= table_size_[a]) return -1;
    index = index * table_size_[a] + at;
  }
  return index;
}

int Continuum::find_block(const std::array<int, 3>& block) const {
  const int index = table_index(block);
  return index < 0 ? -1 : table_[static_cast<std::size_t>(index)];
}

int Continuum::make_block(const std::array<int, 3>& block) {
  const int index = table_index(block);
  if (index < 0) throw Error(ErrorKind::unstable, "the solve lost a particle: it crossed several cells in one step");
  int& at = table_[static_cast<std::size_t>(index)];
  if (at < 0) {
    at = static_cast<int>(blocks_.size());
    blocks_.push_back({block});
    nodes_.resize(nodes_.size() + block_nodes, Node{});
  }
  return at;
}

/// The stencils of a block reach those above it.
void Continuum::make_blocks_above(const std::array<int, 3>& block) {
  for (int n = 0; n < 8; ++n) make_block(plus(block, n >> 2, n >> 1 & 1, n & 1));
}

void Continuum::take_out_escaped() {
  if (followed_.isEmpty()) return;
  for (PointChunk& chunk : chunks_)
    for (int lane = 0; lane < chunk_size; ++lane) {
      const int id = chunk.id[lane];
      if (id < 0) continue;
      PointState state = read(chunk, lane);
      const Vec3 position = state.material_position + state.displacement;
      if (followed_.contains(position)) continue;
      if (!position.allFinite()) require_finite();
      state.damage = 1;
      failures_ += state.damage_time < 0;
      if (state.damage_time < 0) state.damage_time = constants_.time;
      const Stray at = stencil(id);
      Node sums[4];
      gather(at, sums);
      const double* v = sums[0].value;
      escaped_.push_back({state, Vec3(v[0], v[1], v[2]), constants_.time});
      slot_[static_cast<std::size_t>(id)] = -static_cast<int>(escaped_.size());
      chunk.id[lane] = -1;
    }
}

/// An empty table for these blocks, and those around that strays may enter, and those above these.
void Continuum::lay_table(const std::vector<std::array<int, 3>>& blocks) {
  table_low_ = table_size_ = {0, 0, 0};
  if (!blocks.empty()) {
    auto low = blocks.front(), high = low;
    for (const auto& block : blocks)
      for (std::size_t a = 0; a < 3; ++a) {
        low[a] = std::min(low[a], block[a]);
        high[a] = std::max(high[a], block[a]);
      }
    for (std::size_t a = 0; a < 3; ++a) {
      table_low_[a] = low[a] - 1;
      table_size_[a] = high[a] - low[a] + 4;
    }
  }
  table_.assign(static_cast<std::size_t>(table_size_[0]) * static_cast<std::size_t>(table_size_[1]) *
                    static_cast<std::size_t>(table_size_[2]),
                -1);
}

/// Points block by block, each block beginning with a chunk of its own; the grid where they are.
void Continuum::sort() {
  take_out_escaped();
  std::vector<int> order;
  std::vector<std::array<int, 3>> home(chunks_.size() * chunk_size);
  order.reserve(slot_.size());
  for (std::size_t slot = 0; slot < home.size(); ++slot) {
    const PointChunk& chunk = chunks_[slot / chunk_size];
    const int lane = static_cast<int>(slot % chunk_size);
    if (chunk.id[lane] < 0) continue;
    Vec3 x, u;
    read(chunk.material_position, lane, x);
    read(chunk.displacement, lane, u);
    home[slot] = block_of(x + u);
    order.push_back(static_cast<int>(slot));
  }
  const auto home_of = [&](int slot) -> const std::array<int, 3>& { return home[static_cast<std::size_t>(slot)]; };
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return home_of(a) < home_of(b); });
  std::vector<std::array<int, 3>> holding;
  for (int slot : order)
    if (holding.empty() || holding.back() != home_of(slot)) holding.push_back(home_of(slot));

  const auto old_blocks = std::move(blocks_);
  const auto old_nodes = std::move(nodes_);
  const auto old_second_nodes = std::move(second_nodes_);
  blocks_.clear();
  nodes_.clear();
  lay_table(holding);
  for (const auto& block : holding) make_block(block);
  holding_ = static_cast<int>(holding.size());
  for (const auto& block : holding) make_blocks_above(block);
  carry_velocities(old_blocks, old_nodes, old_second_nodes);

  std::vector<PointChunk> sorted;
  sorted.reserve(chunks_.size() + holding.size());
  int b = -1;
  for (int slot : order) {
    if (b < 0 || home_of(slot) != holding[static_cast<std::size_t>(b)]) {
      ++b;
      blocks_[static_cast<std::size_t>(b)].first_chunk = static_cast<int>(sorted.size());
      blocks_[static_cast<std::size_t>(b)].tile = b;
    }
    const int lane = blocks_[static_cast<std::size_t>(b)].count++ % chunk_size;
    if (lane == 0) sorted.push_back(empty_chunk());
    const Lane from = lane_of(slot);
    const int id = chunks_[from.chunk].id[from.lane];
    write(read(chunks_[from.chunk], from.lane), id, lane, sorted.back());
    slot_[static_cast<std::size_t>(id)] = (static_cast<int>(sorted.size()) - 1) * chunk_size + lane;
  }
  chunks_ = std::move(sorted);
  tiles_.assign(holding.size() * static_cast<std::size_t>(tile_nodes(settings_.spline)), Node{});
  strays_.resize(holding.size());
  passes_.resize(holding.size());
  candidate_slots_.resize(chunks_.size() * chunk_size);
  held_nodes_blocks_ = 0;
  sorted_ = true;
  if (with_optional_effects && cracked_) divide(faces_);
}

void Continuum::carry_velocities(const std::vector<Block>& blocks, const std::vector<Node>& nodes,
                                 const std::vector<Node>& second_nodes) {
  second_nodes_.clear();
  second_tiles_.clear();
  planes_.clear();
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    const int now = find_block(blocks[b].at);
    if (now < 0) continue;
    std::copy_n(nodes.begin() + static_cast<std::ptrdiff_t>(b) * block_nodes, block_nodes,
                nodes_.begin() + static_cast<std::ptrdiff_t>(now) * block_nodes);
    if (!with_optional_effects || blocks[b].planes < 0) continue;
    add_planes(now);
    std::copy_n(second_nodes.begin() + static_cast<std::ptrdiff_t>(blocks[b].planes) * block_nodes, block_nodes,
                second_nodes_.end() - block_nodes);
  }
}

/// Block and index in it of a node; -1: no such block.
std::pair<int, int> Continuum::find_node(const std::array<int, 3>& at) const {
  std::array<int, 3> block;
  int local = 0;
  for (std::size_t a = 0; a < 3; ++a) {
    block[a] = floor_div(at[a], block_edge);
    local = local * block_edge + at[a] - block[a] * block_edge;
  }
  return {find_block(block), local};
}

/// The tile with this index, made when there is none yet and emptied when nothing was added to it in this step.
Node* Continuum::fresh_tile(int& index, bool& live, std::vector<Node>& tiles) const {
  const std::size_t size = static_cast<std::size_t>(tile_nodes(settings_.spline));
  if (index < 0) {
    index = static_cast<int>(tiles.size() / size);
    tiles.resize(tiles.size() + size);
  }
  Node* tile = tiles.data() + static_cast<std::size_t>(index) * size;
  if (!live) std::fill_n(tile, size, Node{});
  live = true;
  return tile;
}

void Continuum::hold(std::vector<HeldRegion> regions) {
  held_ = std::move(regions);
  held_impulses_.assign(held_.size(), Vec3::Zero());
  held_nodes_blocks_ = 0;
}

void Continuum::find_held_nodes() {
  held_nodes_.clear();
  const Vec3 origin(constants_.origin[0], constants_.origin[1], constants_.origin[2]);
  for (std::size_t b = 0; b < blocks_.size(); ++b)
    for (int n = 0; n < block_nodes; ++n) {
      const auto& at = blocks_[b].at;
      const Vec3 cell(block_edge * at[0] + n / 16, block_edge * at[1] + n / 4 % 4, block_edge * at[2] + n % 4);
      for (std::size_t r = 0; r < held_.size(); ++r)
        if (held_[r].region.contains(origin + constants_.cell_size * cell))
          held_nodes_.push_back({static_cast<int>(b) * block_nodes + n, static_cast<int>(r)});
    }
  held_nodes_blocks_ = blocks_.size();
}

void Continuum::hold_nodes() {
  if (held_nodes_blocks_ != blocks_.size()) find_held_nodes();
  for (const HeldNode& at : held_nodes_) {
    const HeldRegion& region = held_[static_cast<std::size_t>(at.region)];
    const auto hold = [&](Node& node) {
      for (int a = 0; a < 3; ++a) {
        if (!region.axes[static_cast<std::size_t>(a)]) continue;
        held_impulses_[static_cast<std::size_t>(at.region)][a] += node.value[3] * (region.velocity[a] - node.value[a]);
        node.value[a] = region.velocity[a];
      }
    };
    hold(nodes_[static_cast<std::size_t>(at.node)]);
    const int planes = blocks_[static_cast<std::size_t>(at.node / block_nodes)].planes;
    if (with_optional_effects && planes >= 0)
      hold(second_nodes_[static_cast<std::size_t>(planes * block_nodes + at.node % block_nodes)]);
  }
}

}  // namespace sunder::mpm
