#pragma once
/// The pass over a block, for the instruction set that the including file is compiled for.
#include "core/optional_effects.h"
#include "mpm/block_pass.h"
#include "mpm/detail/block_sum_impl.h"
#include "mpm/detail/lane_laws.h"

namespace sunder::mpm {
namespace {

/// Beyond these the law says nothing about a solid any more: the point is debris.
constexpr double least_volume_change = -0.5, most_volume_change = 2, most_stretch = 6;
constexpr double infinity = __builtin_inf();

/// spline_weights() for `width` points.
struct QuadraticSpline {
  static constexpr Spline name = Spline::quadratic;
  static void weights(Lanes o, double (*w)[width]) {
    store(w[0], 0.5 * (0.5 - o) * (0.5 - o));
    store(w[1], 0.75 - o * o);
    store(w[2], 0.5 * (0.5 + o) * (0.5 + o));
  }
};

struct CubicSpline {
  static constexpr Spline name = Spline::cubic;
  static void weights(Lanes o, double (*w)[width]) {
    const Lanes r = 1.0 - o;
    store(w[0], r * r * r * (1.0 / 6));
    store(w[1], 2.0 / 3 - o * o * (1.0 - 0.5 * o));
    store(w[2], 2.0 / 3 - r * r * (1.0 - 0.5 * r));
    store(w[3], o * o * o * (1.0 / 6));
  }
};

enum class Stage { step, start, finish };

/// Where `width` points stand in their block.
template <class S>
struct alignas(64) Place {
  static constexpr int nodes = stencil_width(S::name), edge = tile_edge(S::name);
  double weight[3][nodes][width];
  double offset[3][width];  ///< from node 1 of the stencil [cells]
  int base[3][width];       ///< lowest node of the stencil, from that of the block

  /// `position` in cells from the lowest node of the block.
  void set(const Lanes position[3]) {
    // Truncation is the floor where the argument is positive.
    constexpr unsigned bias = 1024;
    for (int a = 0; a < 3; ++a) {
      const IntLanes truncated = __builtin_convertvector(position[a] + (bias - stencil_shift(S::name)), IntLanes);
      // Unsigned: what is not a number converts to the least integer.
      const IntLanes low = reinterpret_cast<IntLanes>(reinterpret_cast<CountLanes>(truncated) - bias);
      const Lanes o = position[a] - __builtin_convertvector(low, Lanes) - 1.0;
      *reinterpret_cast<IntLanes*>(base[a]) = low;
      store(offset[a], o);
      S::weights(o, weight[a]);
    }
  }
  bool at_home(int lane) const {
    return (static_cast<unsigned>(base[0][lane]) < block_edge) & (static_cast<unsigned>(base[1][lane]) < block_edge) &
           (static_cast<unsigned>(base[2][lane]) < block_edge);
  }
  int corner(int lane) const { return (base[0][lane] * edge + base[1][lane]) * edge + base[2][lane]; }
};

/// The nodes of a stencil in one field.
template <class S>
struct OneField {
  Quad* corner;
  Quad& node(int i, int j, int k) const { return corner[(i * Place<S>::edge + j) * Place<S>::edge + k]; }
};

/// The nodes of a stencil that lies in two fields: bit n of `side` tells which one node n belongs to.
template <class S>
struct TwoFields {
  Quad* corner[2];
  unsigned long long side;
  Quad& node(int i, int j, int k) const {
    constexpr int n = Place<S>::nodes;
    return corner[side >> ((i * n + j) * n + k) & 1][(i * Place<S>::edge + j) * Place<S>::edge + k];
  }
};

/// Sums over the stencil of w v and of w v (node - 1) along x, y, z; z first, so that every sum is done once.
template <class S, class Field>
inline void gather(const Place<S>& place, int lane, const Field& field, Quad& v, Quad& sx, Quad& sy, Quad& sz) {
  constexpr int n = Place<S>::nodes;
  const auto w = [&](int axis, int node) { return place.weight[axis][node][lane]; };
  v = sx = sy = sz = Quad{};
#pragma GCC unroll 4
  for (int i = 0; i < n; ++i) {
    Quad plane = {}, along_y = {}, along_z = {};
#pragma GCC unroll 4
    for (int j = 0; j < n; ++j) {
      const Quad first = w(2, 0) * field.node(i, j, 0), third = w(2, 2) * field.node(i, j, 2);
      Quad line = first + third + w(2, 1) * field.node(i, j, 1), moment = third - first;
      if constexpr (n == 4) {
        const Quad fourth = w(2, 3) * field.node(i, j, 3);
        line += fourth;
        moment += 2.0 * fourth;
      }
      const Quad weighted = w(1, j) * line;
      plane += weighted;
      if (j != 1) along_y += (j - 1.0) * weighted;
      along_z += w(1, j) * moment;
    }
    const Quad weighted = w(0, i) * plane;
    v += weighted;
    if (i != 1) sx += (i - 1.0) * weighted;
    sy += w(0, i) * along_y;
    sz += w(0, i) * along_z;
  }
}

/// Adds weight * (momentum + slopes * (node - 1)) to the stencil.
template <class S, class Field>
inline void scatter(const Place<S>& place, int lane, Quad momentum, Quad bx, Quad by, Quad bz, const Field& field) {
  constexpr int n = Place<S>::nodes;
  const auto w = [&](int axis, int node) { return place.weight[axis][node][lane]; };
#pragma GCC unroll 4
  for (int i = 0; i < n; ++i) {
    const Quad plane = w(0, i) * (i == 1 ? momentum : momentum + (i - 1.0) * bx);
    const Quad plane_y = w(0, i) * by, plane_z = w(0, i) * bz;
#pragma GCC unroll 4
    for (int j = 0; j < n; ++j) {
      const Quad line = w(1, j) * (j == 1 ? plane : plane + (j - 1.0) * plane_y), line_z = w(1, j) * plane_z;
#pragma GCC unroll 4
      for (int k = 0; k < n; ++k) field.node(i, j, k) += w(2, k) * (k == 1 ? line : line + (k - 1.0) * line_z);
    }
  }
}

/// One group of `width` points of a block. What no point of a block needs is not asked for each of them: with
/// `two_fields` the nodes around a point may belong to either field, with `books` dissipation is added up.
template <class S, Stage stage, bool two_fields, bool books>
class Group {
 public:
  /// `velocity`: the tiles of velocities that the stencils of the block reach; the second is null without a second
  /// field.
  Group(const StepConstants& constants, const StepHandler& handler, Quad* const velocity[2], BlockPass& pass, int first)
      : c_(constants),
        handler_(handler),
        velocity_tiles_{velocity[0], velocity[1]},
        momentum_tiles_{reinterpret_cast<Quad*>(pass.tile), reinterpret_cast<Quad*>(pass.second.tile)},
        pass_(pass),
        chunk_(pass.chunks[first / chunk_size]),
        motion_(pass.motion ? pass.motion + first / chunk_size : nullptr),
        lane_(first % chunk_size),
        first_(first),
        count_(pass.count - first < width ? pass.count - first : width) {}

  void run() {
    for (int k = 0; k < 9; ++k) h_[k] = load(chunk_.displacement_gradient[k] + lane_);
    if constexpr (stage == Stage::start) {
      for (int a = 0; a < 3; ++a) velocity_[a] = load(motion_->velocity[a] + lane_);
      for (int k = 0; k < 9; ++k) affine_[k] = load(motion_->affine_velocity[k] + lane_);
      place();
    } else {
      place();
      gather_motion();
      move();
    }
    if constexpr (stage == Stage::finish) {
      for (int a = 0; a < 3; ++a) store(motion_->velocity[a] + lane_, velocity_[a]);
      for (int k = 0; k < 9; ++k) store(motion_->affine_velocity[k] + lane_, affine_[k]);
    } else {
      if constexpr (stage == Stage::step) place();
      const Lanes dj = checked_volume_change();
      const Symmetric stress = damaged_stress(dj);
      scatter_momentum(stress, 1.0 + dj);
    }
  }

 private:
  void place() {
    Lanes position[3];
    for (int a = 0; a < 3; ++a) {
      const double low = c_.origin[a] + pass_.cell[a] * c_.cell_size;
      position[a] =
          (load(chunk_.material_position[a] + lane_) - low + load(chunk_.displacement[a] + lane_)) * (1 / c_.cell_size);
    }
    place_.set(position);
  }

  void gather_motion() {
    Quad sums[4][width] = {};
    for (int n = 0; n < count_; ++n) {
      if (!place_.at_home(n)) {
        gather_stray(n, sums);
      } else if (const auto side = side_of(n)) {
        const int corner = place_.corner(n);
        const TwoFields<S> fields{{velocity_tiles_[0] + corner, velocity_tiles_[1] + corner}, side};
        gather<S>(place_, n, fields, sums[0][n], sums[1][n], sums[2][n], sums[3][n]);
      } else {
        const OneField<S> field{velocity_tiles_[0] + place_.corner(n)};
        gather<S>(place_, n, field, sums[0][n], sums[1][n], sums[2][n], sums[3][n]);
      }
    }
    from_quads(sums[0], velocity_[0], velocity_[1], velocity_[2]);
    const double factor = 1 / (spline_moment(S::name) * c_.cell_size);
    for (int a = 0; a < 3; ++a) {
      Lanes s[3];
      from_quads(sums[a + 1], s[0], s[1], s[2]);
      const Lanes o = load(place_.offset[a]);
      for (int r = 0; r < 3; ++r) affine_[3 * r + a] = factor * (s[r] - o * velocity_[r]);
    }
  }

  /// H += dt C (I + H), u += dt v.
  void move() {
    const double dt = c_.time_step;
    Lanes change[9];
    for (int r = 0; r < 3; ++r)
      for (int k = 0; k < 3; ++k)
        change[3 * r + k] = affine_[3 * r + k] + affine_[3 * r] * h_[k] + affine_[3 * r + 1] * h_[3 + k] +
                            affine_[3 * r + 2] * h_[6 + k];
    for (int k = 0; k < 9; ++k) {
      h_[k] += dt * change[k];
      store(chunk_.displacement_gradient[k] + lane_, h_[k]);
    }
    for (int a = 0; a < 3; ++a) {
      double* u = chunk_.displacement[a] + lane_;
      store(u, load(u) + dt * velocity_[a]);
    }
  }

  Lanes checked_volume_change() {
    Lanes dj = volume_change(h_);
    if (any((dj - dj) != 0.0)) pass_.finite = false;
    Lanes stretch = 2.0 * (h_[0] + h_[4] + h_[8]);
    for (int k = 0; k < 9; ++k) stretch += h_[k] * h_[k];
    const Mask out = (dj < least_volume_change) | (dj > most_volume_change) | (stretch > most_stretch);
    if (any(out)) [[unlikely]] {
      for (int k = 0; k < 9; ++k) {
        h_[k] = out ? Lanes{} : h_[k];
        store(chunk_.displacement_gradient[k] + lane_, h_[k]);
      }
      dj = out ? Lanes{} : dj;
      double* damage = chunk_.damage + lane_;
      store(damage, out ? all(1.0) : load(damage));
      double* strength = chunk_.strength + lane_;
      // Debris starts no cracks.
      store(strength, out ? min(load(strength), load(chunk_.threshold + lane_)) : load(strength));
      note_failures(load(damage));
      pass_.resets += __builtin_popcount(bits(out));
    }
    return dj;
  }

  /// Rankine damage and viscosity.
  Symmetric damaged_stress(Lanes dj) {
    const NeoHookeanLanes law{c_.shear_modulus, c_.lame_lambda};
    Symmetric stress = law.cauchy_stress(h_, dj);
    Lanes damage = load(chunk_.damage + lane_);
    if (any((damage > 0.0) | may_exceed(stress, load(chunk_.threshold + lane_)))) {
      const Principal principal(stress);
      soften(principal, damage);
      if (any(damage > 0.0)) {
        const Symmetric tension = principal.tension(stress);
        stress = {stress.xx - damage * tension.xx, stress.yy - damage * tension.yy, stress.zz - damage * tension.zz,
                  stress.xy - damage * tension.xy, stress.xz - damage * tension.xz, stress.yz - damage * tension.yz};
      }
    }
    add_viscosity(damage, 1.0 + dj, stress);
    return stress;
  }

  void soften(const Principal& principal, Lanes& damage) {
    const Lanes largest = principal.value(2);
    const Lanes threshold = load(chunk_.threshold + lane_), strength = load(chunk_.strength + lane_);
    const Mask above = largest > threshold;
    if (!any(above)) return;
    const Mask started = strength < infinity;
    const unsigned candidates = bits(above & ~started);
    for (int n = 0; n < count_; ++n)
      if (candidates >> n & 1) pass_.candidates[pass_.candidate_count++] = first_ + n;
    const Mask grows = above & started;
    if (!any(grows)) return;
    const Lanes reached = min((1.0 + load(chunk_.softening_slope + lane_)) * (1.0 - strength / largest), all(1.0));
    const Lanes after = grows & (reached > damage) ? reached : damage;
    if constexpr (books) {
      // Damage grows at the strain of the end of the step: what it releases is the tensile energy stored there.
      double* dissipated = chunk_.dissipated + lane_;
      const Lanes stored = principal.tensile_energy(c_.shear_modulus, c_.lame_lambda);
      store(dissipated, load(dissipated) + (grows ? (after - damage) * stored : Lanes{}));
    }
    damage = after;
    store(chunk_.damage + lane_, damage);
    store(chunk_.threshold + lane_, grows ? largest : threshold);
    note_failures(damage);
  }

  void note_failures(Lanes damage) {
    double* time = chunk_.damage_time + lane_;
    const Mask failed = (damage >= failed_damage) & (load(time) < 0.0);
    if (!any(failed)) return;
    store(time, failed ? all(c_.time) : load(time));
    pass_.failures += __builtin_popcount(bits(failed));
  }

  void add_viscosity(Lanes damage, Lanes volume, Symmetric& stress) {
    const Lanes viscosity = c_.viscosity * (1.0 - damage);
    const Symmetric rate = {affine_[0],
                            affine_[4],
                            affine_[8],
                            0.5 * (affine_[1] + affine_[3]),
                            0.5 * (affine_[2] + affine_[6]),
                            0.5 * (affine_[5] + affine_[7])};
    stress.xx += viscosity * rate.xx;
    stress.yy += viscosity * rate.yy;
    stress.zz += viscosity * rate.zz;
    stress.xy += viscosity * rate.xy;
    stress.xz += viscosity * rate.xz;
    stress.yz += viscosity * rate.yz;
    if constexpr (books) {
      const Lanes squared = rate.xx * rate.xx + rate.yy * rate.yy + rate.zz * rate.zz +
                            2.0 * (rate.xy * rate.xy + rate.xz * rate.xz + rate.yz * rate.yz);
      pass_.viscous_work += sum(viscosity * volume * squared) * c_.particle_volume * c_.time_step;
    }
  }

  /// m v + (m C - dt V0 J s / moment) (x_i - x_p). Fan (2024) eq. 3.4-3.5 (2.23-2.24 print the opposite sign).
  void scatter_momentum(const Symmetric& s, Lanes volume) {
    const double mass = c_.particle_mass, m = mass * c_.cell_size;
    const Lanes f = volume * (c_.time_step * c_.particle_volume / (spline_moment(S::name) * c_.cell_size));
    const Lanes q[9] = {m * affine_[0] - f * s.xx, m * affine_[1] - f * s.xy, m * affine_[2] - f * s.xz,
                        m * affine_[3] - f * s.xy, m * affine_[4] - f * s.yy, m * affine_[5] - f * s.yz,
                        m * affine_[6] - f * s.xz, m * affine_[7] - f * s.yz, m * affine_[8] - f * s.zz};
    const Lanes ox = load(place_.offset[0]), oy = load(place_.offset[1]), oz = load(place_.offset[2]);
    Lanes p[3];
    for (int r = 0; r < 3; ++r) p[r] = mass * velocity_[r] - (q[3 * r] * ox + q[3 * r + 1] * oy + q[3 * r + 2] * oz);
    Quad momentum[width], bx[width], by[width], bz[width];
    to_quads(p[0], p[1], p[2], all(mass), momentum);
    to_quads(q[0], q[3], q[6], Lanes{}, bx);
    to_quads(q[1], q[4], q[7], Lanes{}, by);
    to_quads(q[2], q[5], q[8], Lanes{}, bz);
    for (int n = 0; n < count_; ++n) {
      if (!place_.at_home(n)) {
        scatter_stray(n, momentum[n], bx[n], by[n], bz[n]);
      } else if (const auto side = side_of(n)) {
        const int corner = place_.corner(n);
        const TwoFields<S> fields{{momentum_tiles_[0] + corner, momentum_tiles_[1] + corner}, side};
        scatter<S>(place_, n, momentum[n], bx[n], by[n], bz[n], fields);
      } else {
        const OneField<S> field{momentum_tiles_[0] + place_.corner(n)};
        scatter<S>(place_, n, momentum[n], bx[n], by[n], bz[n], field);
      }
    }
  }

  /// In which fields the nodes around a point are for it. A point that came to another cell is classified anew.
  unsigned long long side_of(int lane) {
    if constexpr (!two_fields) return 0;
    const int n = lane_ + lane, corner = place_.corner(lane);
    if (chunk_.side_corner[n] != corner) {
      const Stray at = stray(lane);
      chunk_.side[n] = handler_.sides(handler_.self, at.cell, at.material_position);
      chunk_.side_corner[n] = corner;
    }
    return chunk_.side[n];
  }

  Stray stray(int lane) const {
    Stray result;
    for (int a = 0; a < 3; ++a) {
      result.cell[a] = pass_.cell[a] + place_.base[a][lane];
      for (int n = 0; n < 4; ++n) result.weight[a][n] = n < Place<S>::nodes ? place_.weight[a][n][lane] : 0;
      result.material_position[a] = chunk_.material_position[a][lane_ + lane];
    }
    return result;
  }

  void gather_stray(int lane, Quad (*sums)[width]) const {
    Node found[4];
    handler_.gather(handler_.self, stray(lane), found);
    for (int k = 0; k < 4; ++k) sums[k][lane] = load_quad(found[k].value);
  }

  void scatter_stray(int lane, Quad momentum, Quad bx, Quad by, Quad bz) const {
    Stray result = stray(lane);
    store_quad(result.momentum.value, momentum);
    store_quad(result.slope[0].value, bx);
    store_quad(result.slope[1].value, by);
    store_quad(result.slope[2].value, bz);
    handler_.scatter(handler_.self, pass_.block, result);
  }

  const StepConstants& c_;
  const StepHandler& handler_;
  Quad* const velocity_tiles_[2];
  Quad* const momentum_tiles_[2];
  BlockPass& pass_;
  PointChunk& chunk_;
  MotionChunk* motion_;
  const int lane_, first_, count_;
  Place<S> place_;
  Lanes h_[9], velocity_[3], affine_[9];
};

/// The velocities that the stencils of a block reach, side by side.
template <class S>
inline void fill_tile(const Node* const velocity[8], Quad* tile) {
  constexpr int edge = tile_edge(S::name), above = edge - block_edge;
  for (int x = 0; x < 2; ++x)
    for (int y = 0; y < 2; ++y)
      for (int z = 0; z < 2; ++z) {
        const Node* from = velocity[4 * x + 2 * y + z];
        const int nx = x ? above : block_edge, ny = y ? above : block_edge, nz = z ? above : block_edge;
        for (int i = 0; i < nx; ++i)
          for (int j = 0; j < ny; ++j) {
            Quad* to = tile + ((i + block_edge * x) * edge + j + block_edge * y) * edge + block_edge * z;
            for (int k = 0; k < nz; ++k)
              to[k] = from ? load_quad(from[(i * block_edge + j) * block_edge + k].value) : Quad{};
          }
      }
}

/// What every step reads of a chunk. Memory is slower than arithmetic when a body does not fit into the caches.
inline void prefetch(const PointChunk* chunk) {
  const char* from = reinterpret_cast<const char*>(chunk);
  const char* end = reinterpret_cast<const char*>(chunk->strength);
  for (; from < end; from += 64) __builtin_prefetch(from, 1);
}

template <class S, Stage stage, bool two_fields, bool books>
void run_points(const StepConstants& constants, const StepHandler& handler, BlockPass& pass) {
  alignas(64) Quad first_field[tile_nodes(S::name)], second_field[two_fields ? tile_nodes(S::name) : 1];
  Quad* const velocity[2] = {first_field, two_fields ? second_field : nullptr};
  if constexpr (stage != Stage::start) {
    fill_tile<S>(pass.velocity, first_field);
    if constexpr (two_fields) fill_tile<S>(pass.second.velocity, second_field);
  }
  if constexpr (stage != Stage::finish) {
    for (int n = 0; n < tile_nodes(S::name); ++n) store_quad(pass.tile[n].value, Quad{});
    if constexpr (two_fields)
      for (int n = 0; n < tile_nodes(S::name); ++n) store_quad(pass.second.tile[n].value, Quad{});
  }
  for (int first = 0; first < pass.count; first += width) {
    if (first % chunk_size == 0) prefetch(pass.chunks + first / chunk_size + 1);
    Group<S, stage, two_fields, books> group(constants, handler, velocity, pass, first);
    group.run();
  }
}

template <class S, Stage stage, bool two_fields>
void run_fields(const StepConstants& constants, const StepHandler& handler, BlockPass& pass) {
  if constexpr (with_optional_effects && stage != Stage::finish)
    if (constants.books_energy) return run_points<S, stage, two_fields, true>(constants, handler, pass);
  run_points<S, stage, two_fields, false>(constants, handler, pass);
}

template <class S, Stage stage>
void run_pass(const StepConstants& constants, const StepHandler& handler, BlockPass& pass) {
  if constexpr (with_optional_effects)
    if (pass.second.tile) return run_fields<S, stage, true>(constants, handler, pass);
  run_fields<S, stage, false>(constants, handler, pass);
}

template <class S>
constexpr StepKernels kernels = {run_pass<S, Stage::step>, run_pass<S, Stage::start>, run_pass<S, Stage::finish>,
                                 run_sum<S>};

}  // namespace
}  // namespace sunder::mpm
