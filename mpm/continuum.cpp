#include "mpm/continuum.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "core/error.h"
#include "core/optional_effects.h"
#include "mpm/detail/point_access.h"
#include "mpm/rankine.h"

namespace sunder::mpm {
namespace {

/// Strays go one by one: when there are more than this share of all points, sorting is cheaper.
constexpr int points_per_stray = 512;
/// Points sorted again before they are so far from their block that its neighbours no longer reach them [cells].
constexpr int furthest_stray = 2;
/// Cracks move with the body through the grid, by a small part of a cell in so many steps.
constexpr int steps_between_divisions = 64;

std::size_t chunks_for(int count) { return static_cast<std::size_t>((count + chunk_size - 1) / chunk_size); }

}  // namespace

Continuum::Continuum(const std::vector<Vec3>& points, double particle_volume, const Material& material,
                     const ContinuumSettings& settings)
    : settings_(settings),
      elasticity_(material),
      kernels_(step_kernels(settings.spline, settings.instructions)),
      chunks_(chunks_for(static_cast<int>(points.size())), empty_chunk()),
      slot_(points.size()),
      faces_(box_of(points), settings.cell_size) {
  constants_.time_step = settings.time_step;
  constants_.cell_size = settings.cell_size;
  // One cell below the anchor, so that a thin body whose lowest point is there fits into one layer of blocks.
  for (int a = 0; a < 3; ++a) constants_.origin[a] = settings.anchor[a] - settings.cell_size;
  constants_.particle_volume = particle_volume;
  constants_.particle_mass = material.density * particle_volume;
  constants_.shear_modulus = material.shear_modulus();
  constants_.lame_lambda = material.lame_lambda();
  constants_.viscosity = settings.viscosity;
  constants_.books_energy = settings.books_energy;
  for (std::size_t p = 0; p < points.size(); ++p) {
    slot_[p] = static_cast<int>(p);
    PointState state;
    state.material_position = points[p];
    write(state, slot_[p], static_cast<int>(p % chunk_size), chunks_[p / chunk_size]);
  }
}

PointState Continuum::point(int id) const {
  const int slot = slot_[static_cast<std::size_t>(id)];
  if (slot >= 0) return read(chunks_[lane_of(slot).chunk], lane_of(slot).lane);
  const Escaped& e = escaped_[static_cast<std::size_t>(-1 - slot)];
  PointState state = e.state;
  state.displacement += (constants_.time - e.since) * e.velocity;
  return state;
}

void Continuum::set_point(int id, const PointState& state) {
  const Lane at = lane_of(slot_[static_cast<std::size_t>(id)]);
  write(state, id, at.lane, chunks_[at.chunk]);
  sorted_ = false;
}

Vec3 Continuum::displacement(int id) const {
  const int slot = slot_[static_cast<std::size_t>(id)];
  if (slot < 0) return point(id).displacement;
  Vec3 u;
  read(chunks_[lane_of(slot).chunk].displacement, lane_of(slot).lane, u);
  return u;
}

Vec3 Continuum::material_position(int id) const {
  const int slot = slot_[static_cast<std::size_t>(id)];
  if (slot < 0) return point(id).material_position;
  Vec3 x;
  read(chunks_[lane_of(slot).chunk].material_position, lane_of(slot).lane, x);
  return x;
}

Mat3 Continuum::displacement_gradient(int id) const {
  const int slot = slot_[static_cast<std::size_t>(id)];
  if (slot < 0) return point(id).displacement_gradient;
  Mat3 h;
  read(chunks_[lane_of(slot).chunk].displacement_gradient, lane_of(slot).lane, h);
  return h;
}

double Continuum::damage(int id) const {
  const int slot = slot_[static_cast<std::size_t>(id)];
  return slot < 0 ? 1 : chunks_[lane_of(slot).chunk].damage[lane_of(slot).lane];
}

/// Stencil of a point where it is now, without momentum.
Stray Continuum::stencil(int id) const {
  const Lane at = lane_of(slot_[static_cast<std::size_t>(id)]);
  Vec3 x, u;
  read(chunks_[at.chunk].material_position, at.lane, x);
  read(chunks_[at.chunk].displacement, at.lane, u);
  Stray s{};
  for (int a = 0; a < 3; ++a) {
    s.material_position[a] = x[a];
    const double cells = (x[a] - constants_.origin[a] + u[a]) / constants_.cell_size;
    const double low = std::floor(cells - stencil_shift(settings_.spline)), o = cells - low - 1;
    s.cell[a] = static_cast<int>(low);
    spline_weights(settings_.spline, o, s.weight[a]);
  }
  return s;
}

/// See StepHandler.
void Continuum::gather(const Stray& stray, Node sums[4]) const {
  for (int k = 0; k < 4; ++k) sums[k] = Node{};
  const int width = stencil_width(settings_.spline);
  const Vec3 material(stray.material_position[0], stray.material_position[1], stray.material_position[2]);
  for (int i = 0; i < width; ++i)
    for (int j = 0; j < width; ++j)
      for (int k = 0; k < width; ++k) {
        const auto [b, local] = find_node({stray.cell[0] + i, stray.cell[1] + j, stray.cell[2] + k});
        if (b < 0) continue;
        const bool second = with_optional_effects && cracked_ && behind(b, local, material);
        const int block = second ? blocks_[static_cast<std::size_t>(b)].planes : b;
        const Node& node =
            (second ? second_nodes_
                    : nodes_)[static_cast<std::size_t>(block) * block_nodes + static_cast<std::size_t>(local)];
        const double w = stray.weight[0][i] * stray.weight[1][j] * stray.weight[2][k];
        const double factor[4] = {w, w * (i - 1), w * (j - 1), w * (k - 1)};
        for (int s = 0; s < 4; ++s)
          for (int c = 0; c < 3; ++c) sums[s].value[c] += factor[s] * node.value[c];
      }
}

StepHandler Continuum::handler() {
  StepHandler handler;
  handler.self = this;
  handler.gather = [](void* self, const Stray& stray, Node sums[4]) {
    static_cast<const Continuum*>(self)->gather(stray, sums);
  };
  handler.scatter = [](void* self, int block, const Stray& stray) {
    static_cast<Continuum*>(self)->strays_[static_cast<std::size_t>(block)].push_back(stray);
  };
  handler.sides = [](void* self, const int cell[3], const double x[3]) {
    return static_cast<const Continuum*>(self)->sides(cell, Vec3(x[0], x[1], x[2]));
  };
  return handler;
}

/// Adds to the tile of the block that the stencil begins in.
void Continuum::scatter(const Stray& stray) {
  std::array<int, 3> block;
  for (std::size_t a = 0; a < 3; ++a) block[a] = floor_div(stray.cell[a], block_edge);
  const int b = make_block(block);
  make_blocks_above(block);
  const Vec3 material(stray.material_position[0], stray.material_position[1], stray.material_position[2]);
  unsigned long long side = with_optional_effects && cracked_ ? sides(stray.cell, material) : 0;
  Block& home = blocks_[static_cast<std::size_t>(b)];
  Node* const tiles[2] = {fresh_tile(home.tile, home.tile_live, tiles_),
                          side ? fresh_tile(home.second_tile, home.second_live, second_tiles_) : nullptr};
  const int width = stencil_width(settings_.spline), edge = tile_edge(settings_.spline);
  for (int i = 0; i < width; ++i)
    for (int j = 0; j < width; ++j)
      for (int k = 0; k < width; ++k, side >>= 1) {
        const double w = stray.weight[0][i] * stray.weight[1][j] * stray.weight[2][k];
        const auto local = [&](std::size_t a, int n) { return stray.cell[a] - block[a] * block_edge + n; };
        Node& node = tiles[side & 1][(local(0, i) * edge + local(1, j)) * edge + local(2, k)];
        for (int c = 0; c < 4; ++c)
          node.value[c] += w * (stray.momentum.value[c] + (i - 1) * stray.slope[0].value[c] +
                                (j - 1) * stray.slope[1].value[c] + (k - 1) * stray.slope[2].value[c]);
      }
}

// ---- time step --------------------------------------------------------------------------------------------------

void Continuum::run(void (*pass)(const StepConstants&, const StepHandler&, BlockPass&),
                    std::vector<MotionChunk>* motion) {
  const StepHandler rare = handler();
  const std::size_t tile_size = static_cast<std::size_t>(tile_nodes(settings_.spline));
  for (Block& block : blocks_) block.tile_live = block.second_live = false;
  tbb::parallel_for(tbb::blocked_range<int>(0, holding_), [&](const tbb::blocked_range<int>& range) {
    for (int b = range.begin(); b < range.end(); ++b) {
      Block& block = blocks_[static_cast<std::size_t>(b)];
      const std::size_t first = static_cast<std::size_t>(block.first_chunk);
      BlockPass& work = passes_[static_cast<std::size_t>(b)];
      work = BlockPass{};
      work.block = b;
      work.chunks = chunks_.data() + first;
      work.count = block.count;
      for (std::size_t a = 0; a < 3; ++a) work.cell[a] = block_edge * block.at[a];
      for (int n = 0; n < 8; ++n) {
        const int above = find_block(plus(block.at, n >> 2, n >> 1 & 1, n & 1));
        work.velocity[n] = above < 0 ? nullptr : nodes_.data() + static_cast<std::size_t>(above) * block_nodes;
      }
      work.tile = tiles_.data() + static_cast<std::size_t>(block.tile) * tile_size;
      if (with_optional_effects && block.second_tile >= 0) {
        for (int n = 0; n < 8; ++n) {
          const int above = find_block(plus(block.at, n >> 2, n >> 1 & 1, n & 1));
          const int planes = above < 0 ? -1 : blocks_[static_cast<std::size_t>(above)].planes;
          if (planes >= 0)
            work.second.velocity[n] = second_nodes_.data() + static_cast<std::size_t>(planes) * block_nodes;
        }
        work.second.tile = second_tiles_.data() + static_cast<std::size_t>(block.second_tile) * tile_size;
        block.second_live = true;
      }
      work.motion = motion ? motion->data() + first : nullptr;
      work.candidates = candidate_slots_.data() + first * chunk_size;
      strays_[static_cast<std::size_t>(b)].clear();
      pass(constants_, rare, work);
      block.tile_live = true;
    }
  });
  collect();
}

/// What the passes found, and their strays to the grid, block by block.
void Continuum::collect() {
  failed_ = false;
  candidates_.clear();
  bool finite = true;
  for (const BlockPass& work : passes_) {
    finite = finite && work.finite;
    failed_ = failed_ || work.failures > 0;
    failures_ += work.failures;
    viscous_work_ += work.viscous_work;
    resets_ += work.resets;
    for (int n = 0; n < work.candidate_count; ++n)
      candidates_.push_back(work.chunks[work.candidates[n] / chunk_size].id[work.candidates[n] % chunk_size]);
  }
  if (!finite) require_finite();
  std::size_t count = 0;
  for (int b = 0; b < holding_; ++b) {
    const Block block = blocks_[static_cast<std::size_t>(b)];
    for (const Stray& stray : strays_[static_cast<std::size_t>(b)]) {
      for (std::size_t a = 0; a < 3; ++a) {
        const int local = stray.cell[a] - block_edge * block.at[a];
        if (local < -furthest_stray || local >= block_edge + furthest_stray) sorted_ = false;
      }
      scatter(stray);
    }
    count += strays_[static_cast<std::size_t>(b)].size();
  }
  if (count * points_per_stray > slot_.size()) sorted_ = false;
}

void Continuum::start(const std::vector<Motion>& motion) {
  sort();
  std::vector<MotionChunk> given(chunks_.size(), MotionChunk{});
  for (std::size_t id = 0; id < slot_.size(); ++id) {
    const Lane at = lane_of(slot_[id]);
    write(motion[id].velocity, at.lane, given[at.chunk].velocity);
    write(motion[id].affine_velocity, at.lane, given[at.chunk].affine_velocity);
  }
  run(kernels_.start, &given);
}

void Continuum::advance(double time) {
  if (!sorted_)
    sort();
  else if (with_optional_effects && cracked_ && ++steps_since_division_ >= steps_between_divisions)
    divide(faces_);
  constants_.time = time;
  run(kernels_.step, nullptr);
}

std::vector<Motion> Continuum::finish() {
  if (!sorted_) sort();
  std::vector<MotionChunk> wanted(chunks_.size(), MotionChunk{});
  run(kernels_.finish, &wanted);
  require_finite();
  std::vector<Motion> motion(slot_.size());
  for (std::size_t id = 0; id < slot_.size(); ++id) {
    if (slot_[id] < 0) {
      motion[id].velocity = escaped_[static_cast<std::size_t>(-1 - slot_[id])].velocity;
      continue;
    }
    const Lane at = lane_of(slot_[id]);
    read(wanted[at.chunk].velocity, at.lane, motion[id].velocity);
    read(wanted[at.chunk].affine_velocity, at.lane, motion[id].affine_velocity);
  }
  sorted_ = false;
  return motion;
}

void Continuum::push(int id, const Vec3& impulse) {
  Stray stray = stencil(id);
  for (int a = 0; a < 3; ++a) stray.momentum.value[a] = impulse[a];
  scatter(stray);
}

void Continuum::update_grid() {
  const std::size_t tile_size = static_cast<std::size_t>(tile_nodes(settings_.spline));
  tbb::parallel_for(
      tbb::blocked_range<std::size_t>(0, blocks_.size()), [&](const tbb::blocked_range<std::size_t>& range) {
        for (std::size_t b = range.begin(); b < range.end(); ++b) {
          BlockSum sum;
          sum.nodes = nodes_.data() + b * block_nodes;
          for (int n = 0; n < 8; ++n) {
            const int below = find_block(plus(blocks_[b].at, -(n >> 2), -(n >> 1 & 1), -(n & 1)));
            if (below < 0) continue;
            const Block& from = blocks_[static_cast<std::size_t>(below)];
            if (from.tile_live) sum.tile[n] = tiles_.data() + static_cast<std::size_t>(from.tile) * tile_size;
            if (with_optional_effects && from.second_live)
              sum.second_tile[n] = second_tiles_.data() + static_cast<std::size_t>(from.second_tile) * tile_size;
          }
          if (with_optional_effects && blocks_[b].planes >= 0) {
            const std::size_t first = static_cast<std::size_t>(blocks_[b].planes) * block_nodes;
            sum.second_nodes = second_nodes_.data() + first;
            sum.planes = planes_.data() + first;
            sum.friction = friction_;
          }
          kernels_.sum(sum);
        }
      });
  if (!held_.empty()) hold_nodes();
}

// ---- cracks and sums --------------------------------------------------------------------------------------------

void Continuum::start_crack(int id, double strength, double softening_slope) {
  const Lane at = lane_of(slot_[static_cast<std::size_t>(id)]);
  PointChunk& chunk = chunks_[at.chunk];
  chunk.strength[at.lane] = chunk.threshold[at.lane] = strength;
  chunk.softening_slope[at.lane] = softening_slope;
}

void Continuum::lower_threshold(int id, double threshold) {
  const int slot = slot_[static_cast<std::size_t>(id)];
  if (slot < 0) return;
  double& now = chunks_[lane_of(slot).chunk].threshold[lane_of(slot).lane];
  now = std::min(now, threshold);
}

void Continuum::require_finite() const {
  for (std::size_t id = 0; id < slot_.size(); ++id) {
    const PointState p = point(static_cast<int>(id));
    if (p.displacement_gradient.allFinite() && p.displacement.allFinite()) continue;
    char text[400];
    const Mat3& h = p.displacement_gradient;
    std::snprintf(
        text, sizeof text,
        "the solve lost particle %zu at (%g, %g, %g): displacement (%g, %g, %g), displacement gradient (%g, %g, "
        "%g; %g, %g, %g; %g, %g, %g), damage %g; lower the time step (cfl)",
        id, p.material_position[0], p.material_position[1], p.material_position[2], p.displacement[0],
        p.displacement[1], p.displacement[2], h(0, 0), h(0, 1), h(0, 2), h(1, 0), h(1, 1), h(1, 2), h(2, 0), h(2, 1),
        h(2, 2), p.damage);
    throw Error(ErrorKind::unstable, text);
  }
}

Vec3 Continuum::momentum(const std::vector<Motion>& motion) const {
  Vec3 sum = Vec3::Zero();
  for (const Motion& m : motion) sum += particle_mass() * m.velocity;
  return sum;
}

Vec3 Continuum::angular_momentum(const std::vector<Motion>& motion) const {
  Vec3 sum = Vec3::Zero();
  const double moment = particle_mass() * spline_moment(settings_.spline) * cell_size() * cell_size();
  for (int id = 0; id < size(); ++id) {
    const Motion& m = motion[static_cast<std::size_t>(id)];
    const Mat3& c = m.affine_velocity;
    const Vec3 axial(c(2, 1) - c(1, 2), c(0, 2) - c(2, 0), c(1, 0) - c(0, 1));
    sum += particle_mass() * (material_position(id) + displacement(id)).cross(m.velocity) + moment * axial;
  }
  return sum;
}

StoredEnergy Continuum::energy(const std::vector<Motion>& motion) const {
  StoredEnergy sum;
  const double moment = spline_moment(settings_.spline) * cell_size() * cell_size();
  for (int id = 0; id < size(); ++id) {
    const Motion& m = motion[static_cast<std::size_t>(id)];
    sum.kinetic += 0.5 * particle_mass() * (m.velocity.squaredNorm() + moment * m.affine_velocity.squaredNorm());
    const PointState p = point(id);
    const PrincipalStress stress =
        principal_stress(elasticity_.cauchy_stress(p.displacement_gradient, volume_change(p.displacement_gradient)));
    // Shares of the stored energy by the sign of stress, in the quadratic form of small strains.
    double tensile = 0, compressive = 0;
    const double nu = constants_.lame_lambda / (2 * (constants_.lame_lambda + constants_.shear_modulus)),
                 trace = stress.value.sum();
    for (int k = 0; k < 3; ++k) {
      const double strain = (1 + nu) * stress.value[k] - nu * trace;
      (stress.value[k] > 0 ? tensile : compressive) += stress.value[k] * strain;
    }
    const double whole = tensile + compressive;
    const double energy = elasticity_.energy(p.displacement_gradient) * constants_.particle_volume;
    const double share = whole > 0 ? tensile / whole : 0;
    sum.tension += (1 - p.damage) * share * energy;
    sum.compression += (1 - share) * energy;
  }
  return sum;
}

std::size_t Continuum::memory() const {
  return chunks_.size() * sizeof(PointChunk) + slot_.size() * sizeof(int) + nodes_.size() * sizeof(Node) +
         (tiles_.size() + second_tiles_.size() + second_nodes_.size() + planes_.size()) * sizeof(Node) +
         table_.size() * sizeof(int) + blocks_.size() * sizeof(Block) + candidate_slots_.size() * sizeof(int) +
         passes_.size() * sizeof(BlockPass);
}

}  // namespace sunder::mpm
