#pragma once
/// A deformable body as material points that move through a background grid: MLS-MPM (Hu et al. 2018) with APIC
/// transfers (Jiang et al. 2015), neo-Hookean elasticity, Rankine damage and viscosity. What pushes it and where its
/// cracks may start is the business of others.
#include <array>
#include <limits>
#include <utility>
#include <vector>

#include "core/types.h"
#include "mpm/block_pass.h"
#include "mpm/material.h"
#include "mpm/material_bins.h"
#include "mpm/neo_hookean.h"

namespace sunder::mpm {

struct ContinuumSettings {
  double cell_size = 0;        ///< h [m]
  double time_step = 0;        ///< [s]
  double viscosity = 0;        ///< of undamaged material [Pa s]
  Vec3 anchor = Vec3::Zero();  ///< some node lies here [m]
  Spline spline = Spline::quadratic;
  bool books_energy = true;  ///< dissipation is added up: PointState::dissipated, Continuum::viscous_work()
  InstructionSet instructions = best_instruction_set();
};

/// Everything that a point remembers from step to step.
struct PointState {
  Vec3 material_position = Vec3::Zero();  ///< X [m]
  Vec3 displacement = Vec3::Zero();       ///< u = x - X [m]
  Mat3 displacement_gradient = Mat3::Zero();
  double threshold = std::numeric_limits<double>::infinity();  ///< see PointChunk
  double strength = std::numeric_limits<double>::infinity();
  double softening_slope = 0;
  double damage = 0;
  double damage_time = -1;
  double dissipated = 0;
};

struct Motion {
  Vec3 velocity = Vec3::Zero();         ///< [m/s]
  Mat3 affine_velocity = Mat3::Zero();  ///< C [1/s]
};

/// Nodes inside `region`, which stands still in space, move at the given velocity along the axes that are held.
struct HeldRegion {
  Box region;
  Vec3 velocity = Vec3::Zero();  ///< [m/s]
  std::array<bool, 3> axes = {true, true, true};
};

/// A piece of a crack's mid-surface, in material coordinates.
struct CrackFace {
  Vec3 position;  ///< [m]
  Vec3 normal;    ///< unit
};

/// Energies of all points [J].
struct StoredEnergy {
  double kinetic = 0;                   ///< with the affine part, m moment h^2 |C|^2 / 2
  double tension = 0, compression = 0;  ///< elastic, in the principal stresses of either sign, tension after damage
  double elastic() const { return tension + compression; }
};

/// A time step is advance(), any number of push(), then update_grid(). Points are named by their index in the points
/// given. Results do not depend on the number of threads.
class Continuum {
 public:
  /// Each point has volume `particle_volume` [m^3]. Nothing is ever damaged until thresholds are set.
  Continuum(const std::vector<Vec3>& points, double particle_volume, const Material& material,
            const ContinuumSettings& settings);

  int size() const { return static_cast<int>(slot_.size()); }
  PointState point(int id) const;
  /// For set-up, before the first step.
  void set_point(int id, const PointState& state);
  Vec3 displacement(int id) const;
  Vec3 material_position(int id) const;
  Mat3 displacement_gradient(int id) const;
  double damage(int id) const;

  /// Before the first step; without it the body starts at rest. Continue with update_grid().
  void start(const std::vector<Motion>& motion);
  /// From the velocities of the grid to new positions and deformations at `time`, stresses and damage there, and the
  /// momentum of the grid. Errors: ErrorKind::unstable when a state stops being finite.
  void advance(double time);
  /// Adds an impulse to the momentum of the grid around a point [N s].
  void push(int id, const Vec3& impulse);
  /// Adds up the momentum of the grid and makes it velocities.
  void update_grid();
  /// Motion of all points after the last update_grid(); displacements and deformations follow it. The body can only be
  /// started again.
  std::vector<Motion> finish();

  void hold(std::vector<HeldRegion> regions);
  /// Impulse that each held region gave to the body so far [N s].
  const std::vector<Vec3>& held_impulses() const { return held_impulses_; }

  /// From now on material on the two sides of these faces too moves in two velocity fields that touch but do not hold
  /// each other. A node takes the plane of its nearest face, when that is the closest point of the crack and not beyond
  /// its rim; particles behind the plane are in the second field there. `friction`: Coulomb's coefficient between the
  /// fields. Between update_grid() and advance().
  void open(const std::vector<CrackFace>& faces, double friction);
  /// Some crack was opened: steps are made with two fields beside it.
  bool divided() const { return cracked_; }

  /// Points without a crack whose largest principal stress exceeded their threshold in the last advance().
  const std::vector<int>& candidates() const { return candidates_; }
  /// From now on the point follows this softening law.
  void start_crack(int id, double strength, double softening_slope);
  /// The point becomes a candidate at this stress already.
  void lower_threshold(int id, double threshold);
  /// True when some point failed in the last advance(); and how many have so far.
  bool failed() const { return failed_; }
  long failures() const { return failures_; }
  double viscous_work() const { return viscous_work_; }  ///< dissipated so far [J]
  long resets() const { return resets_; }                ///< points whose deformation left the range of the law

  /// Points outside of this box, which the caller moves along, stop taking part when points are sorted next: debris
  /// that is far away. They are failed and keep their velocity.
  void follow(const Box& box) { followed_ = box; }
  bool escaped(int id) const { return slot_[static_cast<std::size_t>(id)] < 0; }
  long escapes() const { return static_cast<long>(escaped_.size()); }

  const NeoHookean& elasticity() const { return elasticity_; }
  double particle_mass() const { return constants_.particle_mass; }
  double cell_size() const { return constants_.cell_size; }
  /// Momentum and angular momentum about the origin, with that of the affine velocities, m moment h^2 axial(C).
  Vec3 momentum(const std::vector<Motion>& motion) const;
  Vec3 angular_momentum(const std::vector<Motion>& motion) const;
  StoredEnergy energy(const std::vector<Motion>& motion) const;
  /// Of points and grid together [bytes].
  std::size_t memory() const;

 private:
  struct Block {
    std::array<int, 3> at;  ///< in blocks
    int first_chunk = 0, count = 0;
    int tile = -1;
    bool tile_live = false;  ///< the tile holds momentum of this step
    int planes = -1;         ///< index of its crack planes and second nodes; -1: one field
    int second_tile = -1;
    bool second_live = false;
  };
  struct Escaped {
    PointState state;
    Vec3 velocity;
    double since;
  };

  // The grid: continuum_grid.cpp.
  void sort();
  void take_out_escaped();
  void lay_table(const std::vector<std::array<int, 3>>& blocks);
  void carry_velocities(const std::vector<Block>& blocks, const std::vector<Node>& nodes,
                        const std::vector<Node>& second_nodes);
  std::array<int, 3> block_of(const Vec3& position) const;
  int table_index(const std::array<int, 3>& block) const;
  int find_block(const std::array<int, 3>& block) const;
  std::pair<int, int> find_node(const std::array<int, 3>& at) const;
  int make_block(const std::array<int, 3>& block);
  void make_blocks_above(const std::array<int, 3>& block);
  Node* fresh_tile(int& index, bool& live, std::vector<Node>& tiles) const;
  void find_held_nodes();
  void hold_nodes();
  // Two fields: continuum_cracks.cpp.
  using FaceBins = MaterialBins<std::vector<CrackFace>>;
  void divide(const FaceBins& near);
  void find_planes(const FaceBins& near, std::vector<bool>& changed);
  void find_sides(const std::vector<bool>& changed);
  void add_planes(int block);
  Node plane_at(const Vec3& material_position) const;
  bool faces_near(const FaceBins& faces, const Vec3& low, const Vec3& high) const;
  Vec3 mean_displacement(const Block& block) const;
  unsigned long long sides(const int cell[3], const Vec3& material_position) const;
  bool behind(int block, int local, const Vec3& material_position) const;
  // The step: continuum.cpp.
  void run(void (*pass)(const StepConstants&, const StepHandler&, BlockPass&), std::vector<MotionChunk>* motion);
  void scatter(const Stray& stray);
  void require_finite() const;
  Stray stencil(int id) const;
  void gather(const Stray& stray, Node sums[4]) const;
  StepHandler handler();
  void collect();

  const ContinuumSettings settings_;
  const NeoHookean elasticity_;
  const StepKernels& kernels_;
  StepConstants constants_;
  std::vector<PointChunk> chunks_;
  std::vector<int> slot_;  ///< of each point: chunk * chunk_size + lane, or -1 - index in escaped_
  std::vector<Escaped> escaped_;

  // The grid: a dense table of sparse blocks. Those that hold points come first.
  std::array<int, 3> table_low_ = {0, 0, 0}, table_size_ = {0, 0, 0};
  std::vector<int> table_;
  std::vector<Block> blocks_;
  int holding_ = 0;
  std::vector<Node> nodes_, tiles_;

  // The second field, in blocks with crack planes only.
  FaceBins faces_;
  double friction_ = 0;
  bool cracked_ = false;
  int steps_since_division_ = 0;
  std::vector<Node> second_nodes_, second_tiles_;
  std::vector<Node> planes_;  ///< crack plane of a node: unit normal and offset along it [m]; zero: none

  std::vector<std::vector<Stray>> strays_;  ///< by block
  std::vector<BlockPass> passes_;
  std::vector<int> candidate_slots_, candidates_;

  std::vector<HeldRegion> held_;
  struct HeldNode {
    int node, region;
  };
  std::vector<HeldNode> held_nodes_;
  std::size_t held_nodes_blocks_ = 0;  ///< blocks that held_nodes_ was made for
  std::vector<Vec3> held_impulses_;

  Box followed_;
  bool sorted_ = false, failed_ = false;
  double viscous_work_ = 0;
  long resets_ = 0, failures_ = 0;
};

}  // namespace sunder::mpm
