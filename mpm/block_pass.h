#pragma once
/// One time step of the points of one block of the grid: the part that is compiled once per instruction set.
///
/// Fused: grid to particle, deformation, stress, damage, particle to grid in one pass over the points, so that velocity
/// and affine velocity never leave the registers. A block reads the velocities of its nodes and those just above it and
/// writes its contributions to a tile of its own; tiles are added up in a fixed order afterwards. So sums have one
/// order whatever the number of threads, without atomics or colours.
#include "mpm/point_chunk.h"
#include "mpm/spline.h"

namespace sunder::mpm {

/// Cells per edge of a block, and of the tile that the stencils of its points reach.
constexpr int block_edge = 4, block_nodes = block_edge * block_edge * block_edge;
static constexpr int tile_edge(Spline spline) { return block_edge + stencil_width(spline) - 1; }
static constexpr int tile_nodes(Spline spline) { return tile_edge(spline) * tile_edge(spline) * tile_edge(spline); }

/// Momentum or velocity, then mass.
struct alignas(32) Node {
  double value[4];
};

struct StepConstants {
  double time = 0, time_step = 0, cell_size = 0;
  double origin[3] = {0, 0, 0};  ///< of node (0, 0, 0) [m]
  double particle_volume = 0, particle_mass = 0;
  double shear_modulus = 0, lame_lambda = 0;
  double viscosity = 0;      ///< of undamaged material [Pa s]
  bool books_energy = true;  ///< viscous work and what damage dissipates are added up
};

/// A point that left its block since points were last sorted, on its way to the grid: momentum at the node `cell` + 1
/// of its stencil, and its change per cell along the axes.
struct Stray {
  int cell[3];
  double weight[3][4];
  double material_position[3];
  Node momentum, slope[3];
};

/// For what is rare.
struct StepHandler {
  void* self = nullptr;
  /// Sums over the stencil of a stray: velocity, and velocity times (node - 1) along each axis.
  void (*gather)(void* self, const Stray& stray, Node sums[4]) = nullptr;
  void (*scatter)(void* self, int block, const Stray& stray) = nullptr;
  /// Bits of PointChunk::side of a point whose stencil begins at `cell`.
  unsigned long long (*sides)(void* self, const int cell[3], const double material_position[3]) = nullptr;
};

/// Material on the two sides of a crack moves in two fields of its own. A node that has a crack plane belongs to both;
/// points behind the plane are in the second field there. Blocks without such points have no second field.
struct SecondField {
  const Node* velocity[8] = {};  ///< as BlockPass::velocity; null where no node has a plane
  Node* tile = nullptr;          ///< null: the block has one field
};

/// Input and output of the pass over one block.
struct BlockPass {
  int block = 0;
  PointChunk* chunks = nullptr;
  int count = 0;                 ///< points
  int cell[3] = {0, 0, 0};       ///< lowest cell
  const Node* velocity[8] = {};  ///< nodes of the block and of those above it in [x][y][z]; null: at rest
  Node* tile = nullptr;          ///< momentum and mass from the points of the block
  SecondField second;
  MotionChunk* motion = nullptr;  ///< given (start) or wanted (finish), by chunk
  int* candidates = nullptr;      ///< points without a crack above their threshold, as indices in the block
  int candidate_count = 0;
  double viscous_work = 0;  ///< dissipated by viscosity in this step [J]
  int resets = 0;           ///< points whose deformation left the range of the law and was set back to none
  int failures = 0;         ///< points that failed in this step
  bool finite = true;       ///< false: some state is not a number
};

/// Adds up the tiles that reach a block, [x][y][z] of how many blocks below, and divides by the mass.
struct BlockSum {
  const Node* tile[8] = {};
  Node* nodes = nullptr;
  const Node* second_tile[8] = {};
  Node* second_nodes = nullptr;  ///< null: one field
  const Node* planes = nullptr;  ///< crack planes: unit normal towards the first field, offset; zero: none
  double friction = 0;           ///< Coulomb's coefficient between the fields
};

/// The functions of one spline. A law other than the neo-Hookean one with Rankine damage is another set of them.
struct StepKernels {
  void (*step)(const StepConstants&, const StepHandler&, BlockPass&);
  /// Motion given instead of gathered: no time passes.
  void (*start)(const StepConstants&, const StepHandler&, BlockPass&);
  /// Motion is gathered and displacements and deformation updated; nothing goes to the grid.
  void (*finish)(const StepConstants&, const StepHandler&, BlockPass&);
  void (*sum)(const BlockSum&);
};

enum class InstructionSet { portable, avx2, avx512 };

/// AVX2 and AVX-512 give the same bits, the portable one the same to rounding.
bool has(InstructionSet set);
InstructionSet best_instruction_set();
const char* name_of(InstructionSet set);
const StepKernels& step_kernels(Spline spline, InstructionSet set);

}  // namespace sunder::mpm
